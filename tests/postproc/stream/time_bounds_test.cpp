// What is left to win: bounds that nothing comes below, whatever is written.
#include "postproc/stream/time_bounds.h"

#include <gtest/gtest.h>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

TimeBounds bounds_of(const std::string& text, const Machine& machine,
                     std::optional<double> tolerance = {}) {
  const ReadText read(text);
  return time_bounds(read.program, read.meaning, machine, tolerance);
}

TEST(TimeBounds, AreBelowWhatIsWrittenAndFallWithTheTolerance) {
  for (const char* target : {"linuxcnc", "grbl", "fanuc"}) {
    for (const double height : {0.5, 4.0}) {
      for (const double feed : {800.0, 6000.0}) {
        SCOPED_TRACE(fmt::format("{}, {} mm, F{}", target, height, feed));
        const std::string text = wave_program({.height = height, .length = 8, .feed = feed});
        SmoothOptions options = options_for(target);
        const BoundedTime path = bounds_of(text, *options.machine).seconds;
        double before = path.least_on_path;
        EXPECT_LE(path.least_on_path, path.time);
        for (const double tolerance : {0.002, 0.01, 0.05}) {
          options.tolerance_mm = tolerance;
          const SmoothResult written = smoothed(text, options);
          const BoundedTime near = bounds_of(text, *options.machine, tolerance).seconds;
          EXPECT_NEAR(near.time, written.runs_before_s, 1e-5 * near.time);
          EXPECT_LE(near.least(), written.runs_after_s);
          EXPECT_LE(near.least(), before);
          before = near.least();
        }
      }
    }
  }
}

TEST(TimeBounds, AreThoseOfTheRunsTogetherAndTheMostToWinFirst) {
  const std::string wave = joined(wave_lines({.height = 4, .length = 8, .feed = 6000}), "\n");
  const std::string slow = joined(wave_lines({.lines = 60, .feed = 300}), "\n");
  const std::string text = head("G21") + slow + "G0 Z5\nG0 X0 Y0\nG1 Z-1 F300\n" + wave + tail();
  const TimeBounds bounds = bounds_of(text, *find_machine("linuxcnc"), 0.01);
  ASSERT_EQ(bounds.runs.size(), 2U);
  double time = 0;
  double least = 0;
  for (const RunBound& run : bounds.runs) {
    time += run.seconds.time;
    least += run.seconds.least();
  }
  EXPECT_NEAR(bounds.seconds.time, time, 1e-9);
  EXPECT_NEAR(bounds.seconds.least(), least, 1e-9);
  EXPECT_GT(bounds.runs[0].first_line, bounds.runs[1].first_line);
}

}  // namespace
}  // namespace batten::postproc
