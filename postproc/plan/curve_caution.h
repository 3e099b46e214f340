// What a user has to be told of the curves that were written for him.
#pragma once

#include <optional>
#include <span>

#include "gcode/diagnostic.h"
#include "gcode/program.h"
#include "postproc/pipeline.h"

namespace batten::postproc {

// The warning `curves-unverified` at the first run that became curves, in the words of the target's
// CurveFormat::caution; `program` may be the part of it with these runs. Nothing where no run did,
// or the target has nothing to say.
[[nodiscard]] std::optional<gcode::Diagnostic> curve_caution(std::span<const RunReport> runs,
                                                             const gcode::Program& program,
                                                             const gcode::Dialect& target);

}  // namespace batten::postproc
