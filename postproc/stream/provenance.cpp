#include "postproc/stream/provenance.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "gcode/curves/curve_format.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::postproc {

namespace {

constexpr std::string_view kSmoothed = "Batten: smoothed within ";

// Digits of the tolerance in the comment: a ten-thousandth of the usual 0.01 mm.
constexpr gcode::NumberFormat kTolerance = {6, false, false};

}  // namespace

std::string provenance_comment(const gcode::Control& target, double tolerance_mm) {
  return comment_line(target,
                      std::string(kSmoothed) + gcode::to_text(tolerance_mm, kTolerance) + " mm");
}

// Some controls have no small letters.
bool was_smoothed(const gcode::Program& program) {
  const auto same = [](char a, char b) { return gcode::upper(a) == gcode::upper(b); };
  return std::ranges::any_of(program.comments, [&](const gcode::Comment& comment) {
    const std::string_view text = program.source.text(comment.span);
    return std::search(text.begin(), text.end(), kSmoothed.begin(), kSmoothed.end(), same) !=
           text.end();
  });
}

gcode::Diagnostics notes_on_runs(std::span<const RunReport> runs, const gcode::Program& program,
                                 const gcode::Control& target) {
  gcode::Diagnostics notes;
  const auto tell_first = [&](gcode::Severity severity, const char* id, std::string message,
                              const auto& holds) {
    const auto first = std::ranges::find_if(runs, [&](const RunReport& run) {
      return run.status == RunStatus::kRewritten && holds(run);
    });
    if (first == runs.end()) return;
    notes.push_back({severity, id,
                     program.blocks[first->first_line - program.blocks.front().line].span,
                     std::move(message)});
  };
  if (provenance_comment(target, 1).empty()) {
    tell_first(gcode::Severity::kNote, "missing-provenance",
               "target " + std::string(target.name) +
                   " has no certain comment, so nothing in the program says that it was smoothed: "
                   "smoothing it once more would add its tolerance again",
               [](const RunReport&) { return true; });
  }
  if (target.curves != nullptr && !target.curves->caution.empty()) {
    tell_first(gcode::Severity::kWarning, "curves-unverified", std::string(target.curves->caution),
               [](const RunReport& run) { return run.form == OutputForm::kCurves; });
  }
  tell_first(
      gcode::Severity::kNote, "chords-for-steps",
      "the equal steps of --linearize ilca are too many for this run; found chords, expected "
      "equal steps",
      [](const RunReport& run) { return run.chords_for_steps; });
  return notes;
}

}  // namespace batten::postproc
