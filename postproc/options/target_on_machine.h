// Targets and machines: a target as it is set up on a machine, the one that a machine has.
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

// The control that alone runs machines of this model: its curves and dwells are known where a
// machine is. nullptr where several do.
[[nodiscard]] const gcode::Control* only_control_of(ControllerModel model);

}  // namespace batten::postproc
