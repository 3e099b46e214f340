// Programs whose numbers are expressions of variables: smoothed where these are certain, and left
// to who turns them where that is asked for.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// A wave with every X and Y times a scale.
std::string scaled_wave(const std::string& before, const std::string& middle = "") {
  std::string text = before + head("G21");
  int line = 0;
  for (const std::string& each : wave_lines({})) {
    const std::size_t x = each.find('X');
    const std::size_t y = each.find(" Y");
    const std::size_t end = std::min(each.find(" F"), each.size());
    text += each.substr(0, x) + "X[#<scale>*" + each.substr(x + 1, y - x - 1) + "]Y[#<scale>*" +
            each.substr(y + 2, end - y - 2) + "]" + each.substr(end) + "\n";
    if (++line == 100) text += middle;
  }
  return text + tail();
}

TEST(Expressions, OfCertainValueAreSmoothedAndProved) {
  const std::string text = scaled_wave("#<scale> = 1.5\n");
  const SmoothResult result = smoothed(text, options_for("linuxcnc"));
  EXPECT_TRUE(result.proved);
  ASSERT_EQ(rewritten_runs(result), 1U);
  const auto run = std::ranges::find(result.runs, RunStatus::kRewritten, &RunReport::status);
  EXPECT_EQ(run->computed_blocks, run->blocks_in);
  EXPECT_LT(result.text.size(), text.size() / 2);
  EXPECT_TRUE(result.text.starts_with("#<scale> = 1.5\n"));
  // The path is the scaled one: 1.5 * 0.2 * 200.
  EXPECT_NE(result.text.find("X60"), std::string::npos);
}

TEST(Expressions, StayWhereTheUserTurnsThem) {
  const std::string text = scaled_wave("#<scale> = 1.5\n");
  SmoothOptions options = options_for("linuxcnc");
  options.keep_expressions = true;
  EXPECT_EQ(smoothed(text, options).text, text);
}

TEST(Expressions, StayWhereTheirValueIsNotCertain) {
  for (const std::string& text :
       {scaled_wave(""), scaled_wave("#<scale> = #<_ini[part]scale>\n"),
        scaled_wave("#<scale> = 1.5\no1 if [#5 GT 1]\n#<scale> = 2\no1 endif\n"),
        scaled_wave("o1 while [#<scale> LT 3]\n#<scale> = 1.5\n") + "o1 endwhile\n"}) {
    const SmoothResult result = smoothed(text, options_for("linuxcnc"));
    EXPECT_EQ(result.text, text);
    EXPECT_EQ(rewritten_runs(result), 0U);
  }
}

// What was smoothed for one scale is not what another one means.
TEST(Expressions, AreComparedByTheirValues) {
  const std::string old_text = scaled_wave("#<scale> = 1.5\n", "#<scale> = 1.501\n");
  const std::string new_text = smoothed(old_text, options_for("linuxcnc")).text;
  ASSERT_NE(new_text, old_text);
  const auto proved = [&](const std::string& before, const std::string& after) {
    const ReadText old_read(before, gcode::Language::kRs274);
    const ReadText new_read(after, gcode::Language::kRs274);
    return verify({&old_read.program, &old_read.meaning}, {&new_read.program, &new_read.meaning},
                  0.01)
        .proved();
  };
  EXPECT_TRUE(proved(old_text, new_text));
  EXPECT_FALSE(proved(scaled_wave("#<scale> = 1.52\n", "#<scale> = 1.501\n"), new_text));
  EXPECT_FALSE(proved(scaled_wave("#<scale> = 1.5\n"), new_text));
  EXPECT_FALSE(proved(old_text, replaced(new_text, "#<scale> = 1.501\n", "")));
  EXPECT_FALSE(proved(old_text, replaced(new_text, "#<scale> = 1.501", "#<scale> = 1.502")));
}

}  // namespace
}  // namespace batten::postproc
