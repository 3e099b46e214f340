// What a user has to be told of the form in which runs were written.
#pragma once

#include <span>

#include "gcode/control/control.h"
#include "gcode/text/program.h"
#include "postproc/stream/run_report.h"

namespace batten::postproc {

// At the first run that it is true of, each:
// - the warning `curves-unverified` for curves, in the words of the target's CurveFormat::caution;
// - the note `chords-for-steps` for chords in the place of the equal steps that were asked for.
// `program` may be the part of it with these runs.
[[nodiscard]] gcode::Diagnostics form_notes(std::span<const RunReport> runs,
                                            const gcode::Program& program,
                                            const gcode::Control& target);

}  // namespace batten::postproc
