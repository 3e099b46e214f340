#include "postproc/plan/curve_caution.h"

#include <algorithm>
#include <string>

#include "gcode/curves/curve_format.h"
#include "gcode/dialect.h"

namespace batten::postproc {

std::optional<gcode::Diagnostic> curve_caution(std::span<const RunReport> runs,
                                               const gcode::Program& program,
                                               const gcode::Dialect& target) {
  if (target.curves() == nullptr || target.curves()->caution().empty()) return std::nullopt;
  const auto first = std::ranges::find_if(runs, [](const RunReport& run) {
    return run.status == RunStatus::kRewritten && run.form == OutputForm::kCurves;
  });
  if (first == runs.end()) return std::nullopt;
  return gcode::Diagnostic{gcode::Severity::kWarning, "curves-unverified",
                           program.blocks[first->first_line - program.blocks.front().line].span,
                           std::string(target.curves()->caution())};
}

}  // namespace batten::postproc
