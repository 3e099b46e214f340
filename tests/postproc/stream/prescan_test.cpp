// The first pass over a long program: the same for any number of threads, and ended as soon as it
// says so.
#include "postproc/stream/prescan.h"

#include <gtest/gtest.h>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// Cuts between rapids, in `passes` parts of some more than 5000 blocks.
std::string passes_text(int passes, const std::string& behind = "") {
  std::string text = "G21 G90 G17\nS9000 M3\n";
  for (int i = 0; i < passes; ++i) {
    text += "G0 X0 Y0 Z5\nG1 Z-1 F300\n" + joined(wave_lines({.lines = 5000}), "\n") + "G0 Z5\n";
  }
  return text + behind + "M30\n";
}

PrescanReport prescanned(const std::string& text, int threads, const ProgressCallback& tell) {
  const gcode::SourceText source("part.nc", text);
  SmoothOptions options = options_for("linuxcnc");
  options.threads = threads;
  return prescan(source, options, {.least_blocks = 4000}, tell);
}

bool always_on(double) { return true; }

TEST(Prescanner, FindsTheSameWindowsForAnyNumberOfThreads) {
  const std::string text = passes_text(6);
  const PrescanReport one = prescanned(text, 1, always_on);
  ASSERT_EQ(one.outcome, PrescanOutcome::kWindows);
  EXPECT_EQ(one.windows.size(), 7U) << "the last one has what stands behind the passes";
  EXPECT_EQ(one.units, gcode::Units::kMillimetre);
  for (const int threads : {2, 3, 8}) {
    const PrescanReport more = prescanned(text, threads, always_on);
    ASSERT_EQ(more.outcome, PrescanOutcome::kWindows);
    EXPECT_EQ(more.blocks, one.blocks);
    ASSERT_EQ(more.windows.size(), one.windows.size());
    for (std::size_t i = 0; i < one.windows.size(); ++i) {
      EXPECT_EQ(more.windows[i].begin, one.windows[i].begin);
      EXPECT_EQ(more.windows[i].end, one.windows[i].end);
      EXPECT_EQ(more.windows[i].from.text.begin, one.windows[i].from.text.begin);
      EXPECT_EQ(more.windows[i].from.text.blocks, one.windows[i].from.text.blocks);
      EXPECT_EQ(more.windows[i].from.before.control.first_motion.begin,
                one.windows[i].from.before.control.first_motion.begin);
    }
  }
}

// A loop, a jump, and words behind the last mark: late ones.
TEST(Prescanner, SaysThatTheWholeIsNeededHoweverLateThatShows) {
  for (const char* line : {"o1 while [#1 lt 2]\n", "GOTO 10\n", "%\nG1 X1\n%\n"}) {
    for (const int threads : {1, 2, 8}) {
      EXPECT_EQ(prescanned(passes_text(3, line), threads, always_on).outcome,
                PrescanOutcome::kWhole)
          << line;
    }
  }
}

TEST(Prescanner, TellsHowFarItIsInOrderAndStopsWhereItIsTold) {
  const std::string text = passes_text(6);
  for (const int threads : {1, 2, 8}) {
    std::vector<double> told;
    const auto until_half = [&](double share) {
      told.push_back(share);
      return share < 0.5;
    };
    EXPECT_EQ(prescanned(text, threads, until_half).outcome, PrescanOutcome::kStopped);
    ASSERT_GE(told.size(), 3U);
    EXPECT_TRUE(std::ranges::is_sorted(told));
    EXPECT_LT(told[told.size() - 2], 0.5) << "asked again after it was stopped";
    EXPECT_LT(told.back(), 0.8);
  }
}

}  // namespace
}  // namespace batten::postproc
