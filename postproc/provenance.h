// A comment in the written program that says it was smoothed, and within what. Tolerances add
// up: a program that carries it is not smoothed again unless the user allows it.
#pragma once

#include <string>

#include "gcode/dialect.h"
#include "gcode/program.h"

namespace batten::postproc {

// The comment as the target writes it, without a line end; empty when the target has no words
// for it.
[[nodiscard]] std::string provenance_comment(const gcode::Dialect& target, double tolerance_mm);

// Whether a comment of the program says so.
[[nodiscard]] bool was_smoothed(const gcode::Program& program);

}  // namespace batten::postproc
