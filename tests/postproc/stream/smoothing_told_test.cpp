// A smoothed program says so, or its user is told that it cannot.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

bool is_told(const SmoothResult& result) {
  return std::ranges::any_of(result.diagnostics, [](const gcode::Diagnostic& each) {
    return each.id == "smoothing-not-told" && each.severity == gcode::Severity::kNote;
  });
}

// Without G21, which CODESYS has not.
std::string program_without_units() {
  std::string text = wave_program();
  return text.substr(text.find(' ') + 1);
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
    std::string capitals = result.text;  // some controls have no small letters
    std::ranges::transform(capitals, capitals.begin(), [](char c) {
      return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    });
    const bool in_program = capitals.find("BATTEN: SMOOTHED WITHIN 0.01 MM") != std::string::npos;
    EXPECT_NE(is_told(result), in_program) << target.name;
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
