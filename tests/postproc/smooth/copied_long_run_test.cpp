// Nothing is asked of a run that is copied, and no more of it is held than of one that is smoothed.
#include <gtest/gtest.h>

#include <algorithm>

#include "postproc/stream/pipeline.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr LongRunLimits kShort = {.whole_at_most = 400, .shortest = 100, .longest = 200};

std::string one_long_run(int lines) {
  std::string text = "G21 G90 G17\nS9000 M3\nG0 X0 Y0 Z5\nG1 Z-1 F300\n";
  return text + joined(wave_lines({.lines = lines}), "\n") + "G0 Z5\nM30\n";
}

SmoothOptions copying() {
  SmoothOptions options = options_for("linuxcnc");
  options.method = Method::kNone;
  return options;
}

TEST(CopiedLongRun, IsCopiedPieceByPiece) {
  const std::string text = one_long_run(3000);
  const gcode::SourceText source("part.nc", text);
  std::string copy;
  std::size_t longest = 0;
  const ProgramSink sink = {
      [&](std::string_view part) {
        copy += part;
        longest = std::max(longest, static_cast<std::size_t>(std::ranges::count(part, '\n')));
        return true;
      },
      {}};
  const SmoothResult result =
      smooth_program(source, copying(), sink, {}, {0, {.least_blocks = 100, .long_runs = kShort}});
  EXPECT_EQ(copy, text);
  EXPECT_LE(longest, 210U);
  EXPECT_GE(result.runs.size(), 3000U / 200U);
}

// Seconds about the pieces' joints are counted once.
TEST(CopiedLongRun, TakesAsLongAsInOnePiece) {
  const std::string text = one_long_run(2000);
  const gcode::SourceText source("part.nc", text);
  const double whole = smooth_program(source, copying()).runs_before_s;
  const SmoothResult cut =
      smooth_program(source, copying(), {}, {.windows = {.long_runs = kShort}});
  ASSERT_GE(cut.runs.size(), 10U);
  EXPECT_NEAR(cut.runs_before_s, whole, 1e-3 * whole);
  EXPECT_EQ(cut.runs_after_s, cut.runs_before_s);
}

}  // namespace
}  // namespace batten::postproc
