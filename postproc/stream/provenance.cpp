#include "postproc/stream/provenance.h"

#include <algorithm>
#include <string_view>

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
  const auto capital = [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  };
  return std::ranges::any_of(program.comments, [&](const gcode::Comment& comment) {
    const std::string_view text = program.source.text(comment.span);
    const auto found = std::search(text.begin(), text.end(), kSmoothed.begin(), kSmoothed.end(),
                                   [&](char a, char b) { return capital(a) == capital(b); });
    return found != text.end();
  });
}

std::optional<gcode::Diagnostic> missing_provenance(std::span<const RunReport> runs,
                                                    const gcode::Program& program,
                                                    const gcode::Control& target) {
  if (!provenance_comment(target, 1).empty()) return std::nullopt;
  const auto first = std::ranges::find(runs, RunStatus::kRewritten, &RunReport::status);
  if (first == runs.end()) return std::nullopt;
  return gcode::Diagnostic{
      gcode::Severity::kNote, "smoothing-not-told",
      program.blocks[first->first_line - program.blocks.front().line].span,
      "target " + std::string(target.name) +
          " has no certain comment, so nothing in the program says that it was smoothed: smoothing "
          "it once more would add its tolerance again"};
}

}  // namespace batten::postproc
