// Sections that are searched in windows: the same motion as in one piece, and faster where many
// places are hard.
#include "postproc/machine/planner/bent_section.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "geometry/fitting/corners/guo_corner.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/speed_cubic.h"
#include "tests/support/planned_paths.h"

namespace batten::postproc {
namespace {

using geometry::Path;
using geometry::Point3;

constexpr SectionWindows kOnePiece = {.kept = std::numeric_limits<std::size_t>::max() / 4,
                                      .ahead = 0};

// A mill for dies, mm.
KinematicPathLimits mill_limits() {
  KinematicPathLimits limits;
  limits.feed = 2500.0 / 60;
  limits.acceleration.setConstant(10000);
  limits.jerk.setConstant(100000);
  limits.period = 0.0005;
  return limits;
}

// Corners 0.2 mm apart along X and up to `height` mm up and down, rounded within 0.01 mm.
Path zigzag(int corners, double height, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-height, height);
  std::vector<Point3> points;
  for (int i = 0; i < corners; ++i) points.emplace_back(0.2 * i, any(random), 0);
  return geometry::guo_path(points, {}).pieces;
}

struct Solved {
  std::size_t intervals = 0;
  double seconds = 0;
  std::size_t windows = 0;
};

// The longest section of a path.
Solved solved(const Path& path, const SectionWindows& windows) {
  const KinematicPathLimits limits = mill_limits();
  Solved longest;
  for_each_section(path, LimitsOfPieces(&limits, 1), {}, [&](const PlannedSection& section) {
    if (section.is_straight()) return;
    BentSection bent(path, section, LimitsOfPieces(&limits, 1), kQuickPlanDensity, windows);
    bent.solve();
    if (bent.intervals.size() <= longest.intervals) return;
    longest = {bent.intervals.size(), 0, bent.windows};
    for (std::size_t i = 0; i < bent.intervals.size(); ++i) {
      longest.seconds += interval_seconds(bent.intervals[i].length, bent.x.data() + 2 * i);
    }
  });
  return longest;
}

TEST(BentSection, InWindowsTakesTheTimeOfOnePiece) {
  const Path path = zigzag(60, 0.2);
  const Solved whole = solved(path, kOnePiece);
  const Solved cut = solved(path, {.kept = 200, .ahead = 150});
  ASSERT_GT(whole.intervals, 1000U);
  EXPECT_GT(cut.windows, 5U);
  EXPECT_NEAR(cut.seconds, whole.seconds, 2e-4 * whole.seconds);
}

TEST(BentSection, InWindowsEndsWhereManyCornersAreHard) {
  const Solved cut = solved(zigzag(400, 3), {.kept = 1000, .ahead = 150});
  ASSERT_GT(cut.intervals, 15000U);
  EXPECT_GT(cut.windows, cut.intervals / 1000);
}

TEST(BentSection, KeepsTheLimitsAcrossWindows) {
  const Path path = zigzag(120, 3);
  const FeedPlan plan = plan_feed(path, mill_limits(), {}, kQuickPlanDensity);
  ASSERT_GT(plan.nodes.size(), 3000U);
  const Use use = greatest_use(path, plan, mill_limits(), 1e-4);
  EXPECT_LT(use.share, 1.05) << use.where;
}

}  // namespace
}  // namespace batten::postproc
