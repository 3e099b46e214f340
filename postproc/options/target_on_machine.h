// A target as it is set up on a machine.
#pragma once

#include <memory>

#include "gcode/control/control.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

// The control with the settings of the machine by which it cuts arcs into chords: grbl's $12,
// Klipper's `resolution`. Where the machine runs another kind of control, or says what the control
// has, it is the control itself: then `target` must live as long.
[[nodiscard]] std::shared_ptr<const gcode::Control> target_on_machine(const gcode::Control& target,
                                                                      const Machine& machine);

}  // namespace batten::postproc
