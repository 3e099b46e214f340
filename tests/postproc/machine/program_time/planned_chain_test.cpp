// Times of chains by a feed plan: closed forms of lines, and what holds for any chain.
#include "postproc/machine/program_time/planned_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "postproc/machine/planner/feed_plan_straight.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

using geometry::Line;
using geometry::Point3;

constexpr double kPlanFeed = 6000;  // mm/min: 100 mm/s

Machine machine_with_jerk(double jerk) {
  Machine machine;
  set_max_velocity(machine, 300);
  set_max_acceleration(machine, 1000);
  set_max_jerk(machine, jerk);
  return machine;
}

double seconds_of(const std::vector<PlannedPiece>& pieces) {
  double seconds = 0;
  for (const PlannedPiece& piece : pieces) seconds += piece.seconds;
  return seconds;
}

double planned_time_of(const std::vector<TimedPiece>& chain, const Machine& machine,
                       FeedPlanner planner) {
  return seconds_of(planned_chain(chain, machine, planner));
}

TimedPiece cut_along(const Point3& from, const Point3& to, double feed = kPlanFeed) {
  return {Line{from, to}, feed};
}

// From rest to v and down again along X: v / a + a / j at the least for each change of speed.
TEST(PlannedChain, ByJerkIsTheClosedFormOfALine) {
  constexpr double kJerk = 20000;
  const Machine machine = machine_with_jerk(kJerk);
  const double v = kPlanFeed / 60;
  const double change = v / 1000 + 1000 / kJerk;
  const double way = v * change;  // of both changes, each at half the speed in the mean
  const double expected = 2 * change + (80 - way) / v;
  EXPECT_NEAR(planned_time_of({cut_along({0, 0, 0}, {80, 0, 0})}, machine, FeedPlanner::kJerk),
              expected, 1e-4 * expected);
  // Cut in two it is the same.
  EXPECT_NEAR(planned_time_of({cut_along({0, 0, 0}, {30, 0, 0}), cut_along({30, 0, 0}, {80, 0, 0})},
                              machine, FeedPlanner::kJerk),
              expected, 1e-3 * expected);
}

TEST(PlannedChain, StopsAtRightAngles) {
  const Machine machine = machine_with_jerk(20000);
  const std::vector<TimedPiece> square = {cut_along({0, 0, 0}, {40, 0, 0}),
                                          cut_along({40, 0, 0}, {40, 40, 0}),
                                          cut_along({40, 40, 0}, {0, 40, 0})};
  for (const FeedPlanner planner : {FeedPlanner::kJerk, FeedPlanner::kSCurve}) {
    const double one = planned_time_of({square.front()}, machine, planner);
    EXPECT_NEAR(planned_time_of(square, machine, planner), 3 * one, 0.01 * one) << name_of(planner);
  }
}

// Where the feed changes each part keeps its own, and the change of speed is run in one go.
TEST(PlannedChain, KeepsTheFeedOfEachPiece) {
  const Machine machine = machine_with_jerk(20000);
  const std::vector<TimedPiece> chain = {cut_along({0, 0, 0}, {30, 0, 0}, 6000),
                                         cut_along({30, 0, 0}, {60, 0, 0}, 1500),
                                         cut_along({60, 0, 0}, {90, 0, 0}, 6000)};
  for (const FeedPlanner planner : {FeedPlanner::kJerk, FeedPlanner::kSCurve}) {
    SCOPED_TRACE(name_of(planner));
    const std::vector<PlannedPiece> planned = planned_chain(chain, machine, planner);
    double apart = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      EXPECT_GE(planned[i].seconds, 30 / (chain[i].feed / 60) * (1 - 1e-6));
      EXPECT_LE(planned[i].slow_seconds, planned[i].seconds);
      apart += planned_time_of({chain[i]}, machine, planner);
    }
    EXPECT_LT(seconds_of(planned), apart);
    EXPECT_EQ(planned[1].slow_seconds, 0);
  }
}

// Along smooth chains of curves: less jerk never makes a plan faster, S-curves are no faster than
// the least time, and backwards it takes as long.
TEST(PlannedChain, TakesNoLessWithLessJerkAndBackwardsTheSame) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-20, 20);
  for (int i = 0; i < 20; ++i) {
    std::vector<TimedPiece> chain;
    std::vector<TimedPiece> backwards;
    Point3 start(0, 0, 0);
    geometry::Vector3 way(6, 0, 0);
    for (int k = 0; k < 4; ++k) {
      const Point3 end(place(random), place(random), 0);
      const geometry::Vector3 next = 0.3 * (end - start);
      const geometry::CubicBezier bend{{start, start + way, end - next, end}};
      chain.push_back({bend, kPlanFeed});
      backwards.insert(backwards.begin(),
                       {geometry::CubicBezier{{end, end - next, start + way, start}}, kPlanFeed});
      start = end;
      way = next;
    }
    const double high = planned_time_of(chain, machine_with_jerk(50000), FeedPlanner::kJerk);
    const double low = planned_time_of(chain, machine_with_jerk(10000), FeedPlanner::kJerk);
    EXPECT_GE(low, high * (1 - 1e-4)) << i;
    EXPECT_GE(planned_time_of(chain, machine_with_jerk(50000), FeedPlanner::kSCurve), high * 0.99)
        << i;
    EXPECT_NEAR(planned_time_of(backwards, machine_with_jerk(50000), FeedPlanner::kJerk), high,
                2e-3 * high);
    EXPECT_NEAR(planned_time_of(backwards, machine_with_jerk(50000), FeedPlanner::kSCurve),
                planned_time_of(chain, machine_with_jerk(50000), FeedPlanner::kSCurve), 2e-3)
        << i;
  }
}

// Where the machine comes to the feed in no time, stops cost what they cost in a plan.
TEST(PlannedChain, RunsASlowFeedAsItIs) {
  constexpr double kJerk = 50000;
  const geometry::Arc arc{
      {20, 0, 0}, {-20, 0, 0}, {0, 0, 0}, geometry::Vector3::UnitZ(), std::numbers::pi};
  const std::vector<TimedPiece> chain = {{arc, 10}, cut_along({-20, 0, 0}, {30, 0, 0}, 10)};
  const double v = 10.0 / 60;
  const double stop = std::sqrt(v / kJerk);  // half of 2 sqrt(v / jerk), four times
  EXPECT_NEAR(planned_time_of(chain, machine_with_jerk(kJerk), FeedPlanner::kJerk),
              (20 * std::numbers::pi + 50) / v + 4 * stop,
              0.3 * stop);  // the joint is passed at what the machine can change within a period
  // From one piece that is planned to a little longer one that is not.
  const auto slow = [](double length) {
    return planned_time_of({cut_along({0, 0, 0}, {length, 0, 0}, 60)}, machine_with_jerk(kJerk),
                           FeedPlanner::kJerk);
  };
  EXPECT_NEAR(slow(2.8) - slow(2.5), 0.3, 1e-4);
}

TEST(PlannedChain, IsNoModelOfAControl) {
  EXPECT_THROW((void)planned_chain({}, machine_with_jerk(1000), FeedPlanner::kControl),
               std::invalid_argument);
  EXPECT_TRUE(planned_chain({}, machine_with_jerk(1000), FeedPlanner::kJerk).empty());
}

}  // namespace
}  // namespace batten::postproc
