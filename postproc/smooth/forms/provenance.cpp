#include "postproc/smooth/forms/provenance.h"

#include <algorithm>
#include <string_view>

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

}  // namespace batten::postproc
