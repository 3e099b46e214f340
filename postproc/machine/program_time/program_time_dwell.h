// How long a G4 waits.
#pragma once

#include <optional>

#include "gcode/state/block_words.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/program_time/program_time_steps.h"

namespace batten::postproc {

struct DwellTime {
  std::optional<double> seconds;  // nothing: the block does not say, or in turns of a spindle
                                  // whose speed is not known
  bool unit_assumed = false;      // P without a point, where no control was named
};

// X, U: seconds (FANUC). F: seconds, S: turns of the spindle (Sinumerik). P: by `unit`.
[[nodiscard]] DwellTime dwell_of(const gcode::BlockWords& words, gcode::DwellUnit unit,
                                 std::optional<double> spindle_speed);

// What P means in the programs of a control; nullptr: LinuxCNC and grbl count in seconds, whatever
// the program was written for.
[[nodiscard]] gcode::DwellUnit dwell_unit_of(const gcode::Dialect* target, const Machine& machine);

}  // namespace batten::postproc
