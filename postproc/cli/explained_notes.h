// What the messages mean that do not come from reading a program: about its target, the words of
// its profile, the band around its runs, and what was written.
#pragma once

#include <span>

#include "gcode/reading/explained_diagnostics.h"

namespace batten::postproc {

// Every such id, once.
[[nodiscard]] std::span<const gcode::ExplainedDiagnostic> explained_notes();

}  // namespace batten::postproc
