// A comment in the written program that says it was smoothed, and within what. Tolerances add
// up: a program that carries it is not smoothed again unless the user allows it.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "gcode/control/control.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "postproc/stream/run_report.h"

namespace batten::postproc {

// The comment as the target writes it, without a line end; empty when the target has no words
// for it.
[[nodiscard]] std::string provenance_comment(const gcode::Control& target, double tolerance_mm);

// Whether a comment of the program says so.
[[nodiscard]] bool was_smoothed(const gcode::Program& program);

// The note "smoothing-not-told" at the first run that was rewritten, where the target has no
// certain comment: nothing in the text says then that it was smoothed. `program` may be the part of
// it with these runs.
[[nodiscard]] std::optional<gcode::Diagnostic> missing_provenance(std::span<const RunReport> runs,
                                                                  const gcode::Program& program,
                                                                  const gcode::Control& target);

}  // namespace batten::postproc
