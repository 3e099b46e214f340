#include "postproc/stream/form_notes.h"

#include <algorithm>
#include <string>

#include "gcode/curves/curve_format.h"

namespace batten::postproc {

namespace {

template <typename Holds>
void tell_first(std::span<const RunReport> runs, const gcode::Program& program, const Holds& holds,
                gcode::Diagnostic told, gcode::Diagnostics& notes) {
  const auto first = std::ranges::find_if(runs, [&](const RunReport& run) {
    return run.status == RunStatus::kRewritten && holds(run);
  });
  if (first == runs.end()) return;
  told.where = program.blocks[first->first_line - program.blocks.front().line].span;
  notes.push_back(std::move(told));
}

}  // namespace

gcode::Diagnostics form_notes(std::span<const RunReport> runs, const gcode::Program& program,
                              const gcode::Control& target) {
  gcode::Diagnostics notes;
  if (target.curves != nullptr && !target.curves->caution.empty()) {
    tell_first(
        runs, program, [](const RunReport& run) { return run.form == OutputForm::kCurves; },
        {gcode::Severity::kWarning, "curves-unverified", {}, std::string(target.curves->caution)},
        notes);
  }
  tell_first(
      runs, program, [](const RunReport& run) { return run.chords_for_steps; },
      {gcode::Severity::kNote,
       "chords-for-steps",
       {},
       "the equal steps of --linearize ilca are too many for this run; found chords, expected "
       "equal steps"},
      notes);
  return notes;
}

}  // namespace batten::postproc
