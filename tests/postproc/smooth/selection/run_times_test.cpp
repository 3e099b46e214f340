// What a run takes where it is, at three settings of the feed override.
#include "postproc/smooth/selection/run_times.h"

#include <gtest/gtest.h>

#include "postproc/runs/run_path.h"
#include "tests/support/one_run.h"

namespace batten::postproc {
namespace {

// A half circle of 31.4 mm at 3000 mm/min: far from what limits the axes at half of the feed.
TEST(RunTimes, FollowTheOverrideAsFarAsTheMachineCan) {
  const OneRun run(circle_program(100));
  const Machine& machine = *find_machine("linuxcnc-fast");
  const std::vector<TimedPiece> motions = timed_pieces(run.run(), 0, 100);
  const Times times = times_of(motions, machine, gcode::PathMode::kBlending);
  EXPECT_EQ(times.programmed, cutting_time(motions, machine, gcode::PathMode::kBlending));
  EXPECT_GT(times.at_half, 1.8 * times.programmed);
  EXPECT_LT(times.at_half, 2 * times.programmed);
  EXPECT_LE(times.at_one_and_half, times.programmed);
  EXPECT_GE(times.at_one_and_half, times.programmed / 1.5);
  for (auto [feed_override, expected] :
       {std::pair{0.5, times.at_half}, {1.5, times.at_one_and_half}}) {
    std::vector<TimedPiece> overridden = motions;
    for (TimedPiece& each : overridden) each.feed *= feed_override;
    EXPECT_EQ(cutting_time(overridden, machine, gcode::PathMode::kBlending), expected);
  }
}

}  // namespace
}  // namespace batten::postproc
