// The comment that a program was smoothed: written once, found again, whatever stands around it; or
// its user is told that there is none.
#include "postproc/smooth/forms/provenance.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

bool says_so(const std::string& text) { return was_smoothed(ReadText(text).program); }

TEST(Provenance, IsFoundAgainForEveryTarget) {
  for (const gcode::Control& target : gcode::controls()) {
    const std::string comment = provenance_comment(target, 0.01);
    if (comment.empty()) {
      EXPECT_EQ(target.name, "codesys") << "the only one of which no comment is known";
      continue;
    }
    EXPECT_TRUE(says_so("G21\n" + comment + "\nG1 X1\n")) << comment;
    EXPECT_TRUE(says_so("G21\r\n" + comment + "\r\nG1 X1\r\n")) << comment;
    EXPECT_LE(line_length(target, comment), target.max_line_length);
  }
}

TEST(Provenance, TellsTheTolerance) {
  const gcode::Control& target = *gcode::find_control("linuxcnc");
  EXPECT_EQ(provenance_comment(target, 0.01), "(Batten: smoothed within 0.01 mm)");
  EXPECT_EQ(provenance_comment(target, 0.0127), "(Batten: smoothed within 0.0127 mm)");
  EXPECT_EQ(provenance_comment(target, 1), "(Batten: smoothed within 1 mm)");
}

TEST(Provenance, IsFoundInAnyComment) {
  const std::pair<const char*, bool> rows[] = {
      {"G21\nG1 X1\n", false},
      {"(made by Batten)\nG21\n", false},
      {"G21\nM2\n(Batten: smoothed within 0.01 mm)", true},
      {"G21 (Batten: smoothed within 0.01 mm)\n", true},
      {"; Batten: smoothed within 0.05 mm\nG21\n", true},
      {"(part 7, Batten: smoothed within 0.01 mm, checked)\nG21\n", true}};
  for (const auto& [text, smoothed] : rows) EXPECT_EQ(says_so(text), smoothed) << text;
}

bool is_told(const SmoothResult& result) {
  return std::ranges::any_of(result.diagnostics, [](const gcode::Diagnostic& each) {
    return each.id == "missing-provenance" && each.severity == gcode::Severity::kNote;
  });
}

// Without G21, which CODESYS has not; each move with its G1, which Klipper needs.
std::string program_without_units() {
  std::string text = wave_program();
  text.erase(0, text.find(' ') + 1);
  for (std::size_t at = 0; (at = text.find("\nX", at)) != std::string::npos;) {
    text.insert(at + 1, "G1 ");
  }
  return text;
}

SmoothOptions for_target(const gcode::Control& target) {
  SmoothOptions options = options_for("codesys");
  options.target = &target;
  options.units = gcode::Units::kMillimetre;
  return options;
}

TEST(SmoothingTold, EachTargetSaysItInTheProgramOrInANote) {
  for (const gcode::Control& target : gcode::controls()) {
    if (target.language == gcode::Language::kKlartext) continue;
    const SmoothResult result = smoothed(program_without_units(), for_target(target));
    ASSERT_GE(rewritten_runs(result), 1U) << target.name;
    EXPECT_NE(is_told(result), says_so(result.text)) << target.name;
  }
}

TEST(SmoothingTold, NothingIsToldWhereNothingWasSmoothed) {
  const SmoothResult result =
      smoothed("G90 G17\nG0 X0 Y0\nG1 X5 F100\nM2\n", for_target(*gcode::find_control("codesys")));
  EXPECT_EQ(rewritten_runs(result), 0U);
  EXPECT_FALSE(is_told(result));
}

TEST(SmoothingTold, AProfileThatKnowsAControlsCommentsEndsSecondPasses) {
  gcode::Control adapted = *gcode::find_control("codesys");
  adapted.comments = gcode::CommentStyle::kParentheses;
  const SmoothOptions options = for_target(adapted);
  const SmoothResult once = smoothed(program_without_units(), options);
  ASSERT_GE(rewritten_runs(once), 1U);
  EXPECT_FALSE(is_told(once));
  EXPECT_EQ(smoothed(once.text, options).text, once.text);
}

}  // namespace
}  // namespace batten::postproc
