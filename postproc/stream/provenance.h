// A comment in the written program that says it was smoothed, and within what. Tolerances add
// up: a program that carries it is not smoothed again unless the user allows it.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "gcode/control/control.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"
#include "postproc/stream/smooth_result.h"

namespace batten::postproc {

// The comment as the target writes it, without a line end; empty when the target has no words
// for it.
[[nodiscard]] std::string provenance_comment(const gcode::Control& target, double tolerance_mm);

// Whether a comment of the program says so.
[[nodiscard]] bool was_smoothed(const gcode::Program& program);

// What a user has to be told of the runs that were written, at the first run that it is true of:
// - the note `missing-provenance` where the target has no certain comment: nothing in the text says
//   then that it was smoothed;
// - the warning `curves-unverified` for curves, in the words of the target's CurveFormat::caution;
// - the note `chords-for-steps` for chords in the place of the equal steps that were asked for.
// `program` may be the part of it with these runs.
[[nodiscard]] gcode::Diagnostics notes_on_runs(std::span<const RunReport> runs,
                                               const gcode::Program& program,
                                               const gcode::Control& target);

}  // namespace batten::postproc
