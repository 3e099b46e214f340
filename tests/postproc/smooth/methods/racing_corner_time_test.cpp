// The racing corner on the machine of the eight-point corner, by the feed planner.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <variant>

#include "geometry/fitting/corners/time_optimal_corner.h"
#include "postproc/machine/planner/feed_plan.h"
#include "tests/support/planned_paths.h"

namespace batten::postproc {
namespace {

using geometry::time_optimal_corner;
using geometry::TimeOptimalBlend;
using geometry::ToleranceKind;

geometry::TimeOptimalOptions options_for(double tolerance, ToleranceKind kind) {
  geometry::TimeOptimalOptions options;
  options.tolerance = tolerance;
  options.kind = kind;
  options.share_before = options.share_after = 13;
  return options;
}

double time_of(const TimeOptimalBlend& blend) {
  return planned_time(with_legs(blend.blend.curve), corner_limits());
}

struct RacingGoal {
  std::string name;
  double tolerance;
  ToleranceKind kind;
  double time;   // s, at most
  double bound;  // s: no curve can be faster; numerical, good to .001
};

class TimeOptimalCornerTime : public testing::TestWithParam<RacingGoal> {};

TEST_P(TimeOptimalCornerTime, ReachesTheGoalAndNotTheImpossible) {
  const RacingGoal& goal = GetParam();
  const auto found = time_optimal_corner(wide_corner(), options_for(goal.tolerance, goal.kind));
  ASSERT_TRUE(std::holds_alternative<TimeOptimalBlend>(found));
  const auto& blend = std::get<TimeOptimalBlend>(found);
  const double time = time_of(blend);
  fmt::print("{}: {:.5f} s, bound {:.4f}\n", goal.name, time, goal.bound);
  EXPECT_LE(time, goal.time);
  EXPECT_GE(time, goal.bound - .002);
  // The blend's own time is one in which the machine can run it, so the plan needs no more. Each
  // leg has its ramp from 0 to 25 mm/s, with jerk 5000 sqrt(2) along it 2 sqrt(25/7071) s long, at
  // 12.5 mm/s in the mean, and an even part.
  const double length = 13 * std::sqrt(2.0);
  const double ramp = 2 * std::sqrt(25 / (5000 * std::sqrt(2.0)));
  const double legs = 2 * ramp + (2 * length - blend.before - blend.after - 25 * ramp) / 25;
  ASSERT_GT(blend.before, 0);
  EXPECT_LE(time, (blend.time + legs) * (1 + 5e-4));
  EXPECT_LE(blend.time + legs, goal.time);
  EXPECT_GE(blend.time + legs, goal.bound - .002);
}

INSTANTIATE_TEST_SUITE_P(
    Square, TimeOptimalCornerTime,
    testing::Values(RacingGoal{"Band100", .1, ToleranceKind::kBand, 1.6190, 1.6160},
                    RacingGoal{"Band050", .05, ToleranceKind::kBand, 1.6340, 1.6306},
                    RacingGoal{"Path100", .1, ToleranceKind::kPath, 1.6260, 1.6211},
                    RacingGoal{"Path050", .05, ToleranceKind::kPath, 1.6385, 1.6338}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace batten::postproc
