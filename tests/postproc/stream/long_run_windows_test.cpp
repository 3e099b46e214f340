// Runs too long to be held come out of windows as they do of the whole program, cut at the same
// places.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "postproc/proof/verification.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/window.h"
#include "tests/support/in_windows.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr unsigned kLongRunSeeds = 20;

constexpr LongRunLimits kShortRuns = {.whole_at_most = 400, .shortest = 100, .longest = 200};

// Passes of any length up to some multiples of what is held as one, with words, feeds and comments
// in their midst.
class LongPasses {
 public:
  explicit LongPasses(unsigned seed) : random_(seed) {}

  std::string make() {
    text_ = chance(3) ? "G20 G90\nM3 S9000\n" : "G21 G90 G17\nM3 S9000\n";
    scale_ = text_.starts_with("G20") ? 1 / 25.4 : 1;
    const int passes = 1 + pick(3);
    for (int i = 0; i < passes; ++i) pass();
    return text_ + "G0 Z5\nM30\n";
  }

 private:
  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }
  bool chance(int one_in) { return pick(one_in) == 0; }

  [[nodiscard]] std::string number(double mm) const { return fmt::format("{:.5f}", mm * scale_); }

  void pass() {
    static const int kLengths[] = {20, 390, 399, 400, 401, 520, 701, 850, 1100};
    const int lines = kLengths[pick(9)];
    const bool flat = chance(2);
    const double radius = 5 + pick(30);
    text_ += "G0 Z5\nG0 X" + number(radius) + " Y0\nG1 Z-1 F300\n";
    for (int i = 1; i <= lines; ++i) {
      const double angle = 0.2 * i / radius;
      const double waved = radius + 0.4 * std::sin(7 * angle) + 0.01 * i;
      const double z = flat ? -1 : -1 + 0.2 * std::sin(5 * angle);
      text_ += i == 1 ? "G1 F2000 " : "";
      text_ += "X" + number(waved * std::cos(angle)) + " Y" + number(waved * std::sin(angle));
      if (!flat) text_ += " Z" + number(z);
      if (chance(150)) text_ += fmt::format(" F{}", 1500 + 10 * pick(50));
      if (chance(100)) text_ += " (mark)";
      text_ += "\n";
      if (chance(100)) text_ += "(between)\n";
      if (chance(2500)) text_ += "M8\n";
      if (chance(2500)) text_ += "G2 X3 Y3 I9 J2\n";
    }
  }

  std::mt19937 random_;
  std::string text_;
  double scale_ = 1;
};

Verification verdict_under(const SmoothOptions& options, const std::string& before,
                           const std::string& after) {
  const auto read = [&](const std::string& text) {
    gcode::Diagnostics ignored;
    return read_whole(gcode::SourceText("test.nc", text),
                      {.options = {.curves = options.target->curves}}, ignored);
  };
  const gcode::ReadPart old_text = read(before);
  const gcode::ReadPart new_text = read(after);
  return verify({&old_text.program, &old_text.meaning}, {&new_text.program, &new_text.meaning},
                Promise(options.tolerance_mm, options.tolerance_kind, options.side));
}

class LongSeed : public testing::TestWithParam<unsigned> {};

TEST_P(LongSeed, GivesTheSameBytesReportAndMessagesForAnyThreads) {
  const std::string text = LongPasses(GetParam()).make();
  SmoothOptions options = options_of_seed(GetParam());
  const SmoothResult whole = as_a_whole(text, options, kShortRuns);
  EXPECT_TRUE(whole.proved);
  for (const int threads : {1, 2, 3, 8}) {
    if (GetParam() >= 6 && threads % 2 == 0) continue;
    SCOPED_TRACE(threads);
    options.threads = threads;
    const WindowLimits limits = {.least_blocks = 100, .long_runs = kShortRuns};
    const InWindows windows = in_windows(text, options, limits);
    expect_same(windows, whole);
  }
}

INSTANTIATE_TEST_SUITE_P(LongRunWindows, LongSeed, testing::Range(0u, kLongRunSeeds));

TEST(LongRunWindows, AreMadeOfLongRunsAndRewrittenThere) {
  std::size_t cut = 0;
  std::size_t proved_by_others = 0;
  for (unsigned seed = 0; seed < kLongRunSeeds; ++seed) {
    const std::string text = LongPasses(seed).make();
    const SmoothOptions options = options_of_seed(seed);
    const WindowLimits limits = {.least_blocks = 100000, .long_runs = kShortRuns};
    const InWindows windows = in_windows(text, options, limits);
    if (!windows.cut() || rewritten_runs(windows.result) == 0) continue;
    ++cut;  // between rapids alone there is no place for so long windows
    // The verifier that knows of no windows and no cuts has the last word.
    const Verification all = verdict_under(options, text, windows.text);
    EXPECT_TRUE(all.proved()) << seed << ": " << all.violations.front().message;
    proved_by_others += all.proved() ? 1 : 0;
  }
  EXPECT_GE(cut, kLongRunSeeds / 3);
  EXPECT_EQ(proved_by_others, cut);
}

std::string one_run(int lines) {
  std::string text = "G21 G90 G17\nS9000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F300\n";
  return text + joined(wave_lines({.lines = lines}), "\n") + "G0 Z5\nM30\n";
}

// However long a run is, what is held of it is not.
TEST(LongRunWindows, HoldNoMoreOfARunThanAPiece) {
  const gcode::SourceText source("part.nc", one_run(3000));
  const PrescanReport found = prescan(source, options_for("linuxcnc"), {.long_runs = kShortRuns},
                                      [](double) { return true; });
  ASSERT_EQ(found.outcome, PrescanOutcome::kWindows);
  EXPECT_GE(found.windows.size(), 3000U / 200U);
  std::uint32_t begin = 0;
  for (const WindowPlace& window : found.windows) {
    EXPECT_EQ(window.begin, begin);
    begin = window.end;
    const std::string_view text = source.text({window.begin, window.end});
    EXPECT_LE(std::ranges::count(text, '\n'), 210);
    EXPECT_LE(window.from.text.begin, window.begin);
  }
  EXPECT_EQ(begin, source.text().size());
}

// Seconds between the pieces' joints are counted once.
TEST(LongRunWindows, TakeAsLongAsTheRunThatTheyAreCutFrom) {
  SmoothOptions options = options_for("linuxcnc");
  options.method = Method::kFair;
  const std::string text = one_run(2000);
  const double whole = as_a_whole(text, options).runs_before_s;
  const SmoothResult cut = as_a_whole(text, options, kShortRuns);
  ASSERT_GE(cut.runs.size(), 10U);
  EXPECT_NEAR(cut.runs_before_s, whole, 1e-3 * whole);
}

WindowDone second_window(const std::string& text, const TextBefore* begin) {
  const gcode::SourceText source("part.nc", text);
  const SmoothOptions options = options_for("linuxcnc");
  const ProgressCallback go_on = [](double) { return true; };
  const PrescanReport found = prescan(source, options, {.long_runs = kShortRuns}, go_on);
  const WindowSetting setting{source, options, {}, {}, kShortRuns};
  const Guess guess = [&](const TextBefore& old_before) {
    return NewTextBefore{begin != nullptr ? *begin : old_before, false};
  };
  return smooth_window(setting, found.windows.at(1), guess, go_on);
}

// Where the new text before a window would have left the tool elsewhere, nothing of it is proved.
TEST(LongRunWindows, AreNotProvedWhereTheNewTextBeforeThemEndsElsewhere) {
  const std::string text = one_run(600);
  const WindowDone right = second_window(text, nullptr);
  ASSERT_EQ(right.outcome, WindowOutcome::kDone);
  EXPECT_FALSE(right.proof.unchanged);
  TextBefore elsewhere = right.before.known;
  elsewhere.control.state.position.mm.x() += 0.05;
  elsewhere.events.place->x() += 0.05;
  const WindowDone wrong = second_window(text, &elsewhere);
  EXPECT_EQ(wrong.outcome, WindowOutcome::kNotProvedAlone);
  EXPECT_FALSE(same_before(right.before, wrong.before));
  TextBefore in_inches = right.before.known;
  in_inches.control.state.modal.units = gcode::Units::kInch;
  EXPECT_EQ(second_window(text, &in_inches).outcome, WindowOutcome::kNotProvedAlone);
}

}  // namespace
}  // namespace batten::postproc
