// What a program says of having been smoothed.
#pragma once

#include <string>

#include "gcode/control/control.h"
#include "gcode/text/program.h"

namespace batten::postproc {

// The comment that a program was smoothed, and within what, as the target writes it, without a line
// end; empty when the target has no words for it. Tolerances add up: a program with this comment is
// not smoothed again unless the user allows it.
[[nodiscard]] std::string provenance_comment(const gcode::Control& target, double tolerance_mm);

// Whether a comment of the program says so.
[[nodiscard]] bool was_smoothed(const gcode::Program& program);

}  // namespace batten::postproc
