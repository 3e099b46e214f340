// Times of chains by a feed plan: closed forms of lines, and what holds for any chain.
#include "postproc/machine/models/planned_chain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

#include "postproc/machine/planner/feed_plan_straight.h"
#include "tests/support/machine_limits.h"
#include "tests/support/planned_paths.h"

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

// Sampled every 0.1 ms, no limit is exceeded by more than half a percent, nor does the acceleration
// jump where the feed changes or a piece is so slow that it is not planned in its middle: a step of
// it would be one of the jerk's whole limit within a thousandth of the time that it may take.
TEST(PlannedChain, KeepsTheLimitsOfEachPiece) {
  constexpr double kPeriod = 1e-4;
  constexpr double kHalfAPercent = 1.005;
  std::mt19937 random(5);
  for (int i = 0; i < 6; ++i) {
    SCOPED_TRACE(i);
    Machine machine = machine_with_jerk(30000);
    // Feeds of all sizes, longer and shorter than what the machine needs from one to the next.
    std::vector<TimedPiece> chain;
    for (const geometry::CubicBezier& piece : random_curve(random).bezier_pieces()) {
      chain.push_back({piece, 600.0 * static_cast<double>(1 + random() % 12)});
    }
    if (i % 2 == 0) {  // a line between two feeds, and one that takes 120 s
      const geometry::Vector3 way = geometry::direction_at(chain.back().piece, 1);
      const Point3 end = geometry::end_point(chain.back().piece);
      chain.push_back(cut_along(end, end + 0.8 * way, 9000));
      chain.push_back(cut_along(end + 0.8 * way, end + 2.8 * way, 1));
      chain.push_back(cut_along(end + 2.8 * way, end + 3 * way, 6000));
    }
    const PlannedMotion motion(chain, machine, FeedPlanner::kJerk);
    geometry::Path path;
    std::vector<KinematicPathLimits> limits;
    for (const TimedPiece& piece : chain) {
      path.push_back(piece.piece);
      limits.push_back(path_limits_of(machine, piece.feed / 60));
    }
    FeedPlan plan;
    plan.nodes = motion.nodes();
    const Use use = greatest_use(path, plan, limits, kPeriod);
    EXPECT_LE(use.share, kHalfAPercent) << use.where;
    EXPECT_GE(use.share, 0.99);
    // From sample to sample the acceleration changes by the jerk; where the curvature jumps, from
    // the curve to the line behind it, by what the machine can do within its servo period.
    const MotionSample* before = nullptr;
    const std::vector<MotionSample> samples = sample_motion(path, plan, kPeriod);
    for (const MotionSample& m : samples) {
      if (before != nullptr) {
        const geometry::Vector3 change = m.acceleration - before->acceleration;
        const bool to_line = m.piece != before->piece && i % 2 == 0 && m.piece + 3 == path.size();
        const double allowed = kPeriod + (to_line ? machine.servo_period : 0);
        ASSERT_LE(change.cwiseAbs().maxCoeff(), 30000 * allowed * 1.02) << m.time;
        ASSERT_LE((m.velocity - before->velocity).cwiseAbs().maxCoeff(), 1000 * kPeriod * 1.02)
            << m.time;
      }
      before = &m;
    }
  }
}

// Under exact stop each piece takes what it takes alone, whichever they are.
TEST(PlannedChain, StopsAtTheEndOfEachPieceUnderExactStop) {
  std::mt19937 random(7);
  const Machine machine = machine_with_jerk(30000);
  std::vector<TimedPiece> chain;
  for (const geometry::CubicBezier& piece : random_curve(random).bezier_pieces()) {
    chain.push_back({piece, 600.0 * static_cast<double>(1 + random() % 12)});
  }
  const Point3 end = geometry::end_point(chain.back().piece);
  const geometry::Vector3 way = geometry::direction_at(chain.back().piece, 1);
  chain.push_back(cut_along(end, end + 3 * way, 1));  // so slow that its middle is not planned
  chain.push_back(cut_along(end + 3 * way, end + 8 * way));
  for (const FeedPlanner planner : {FeedPlanner::kJerk, FeedPlanner::kSCurve}) {
    SCOPED_TRACE(name_of(planner));
    const auto planned = planned_chain(chain, machine, planner, gcode::PathMode::kExactStop);
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const double alone = planned_time_of({chain[i]}, machine, planner);
      EXPECT_NEAR(planned[i].seconds, alone, 1e-9 * alone) << i;
    }
    EXPECT_LT(planned_time_of(chain, machine, planner), seconds_of(planned) - 0.02);
  }
}

// As along a line of its length at the speed that it allows, though its printed ends are not on one
// circle: the greatest speed would be at one of them.
TEST(PlannedChain, SpeedsUpInOneGoAlongAnArc) {
  const Machine machine = machine_with_jerk(30000);
  constexpr double kRadius = 5.743748;
  constexpr double kSweep = 5;
  const Point3 center(1.1, 7.081903, 0);
  const auto at = [&](double angle, double off) -> Point3 {
    return center + (kRadius + off) * geometry::Vector3(std::cos(angle), std::sin(angle), 0);
  };
  const geometry::Arc arc{at(0.3, 1e-7), at(0.3 + kSweep, 0), center, geometry::Vector3::UnitZ(),
                          kSweep};
  const double allowed = 60 * std::sqrt(1000 * kRadius);
  const double along_line = planned_time_of(
      {cut_along({0, 0, 0}, {kSweep * kRadius, 0, 0}, allowed)}, machine, FeedPlanner::kSCurve);
  EXPECT_NEAR(planned_time_of({{arc, 60000}}, machine, FeedPlanner::kSCurve), along_line, 1e-5);
}

// At any time it is on its piece, and the pieces take the times that they are said to take.
TEST(PlannedChain, IsWhereItsTimesSay) {
  const Machine machine = machine_with_jerk(20000);
  const geometry::Arc arc{
      {30, 0, 0}, {30, 20, 0}, {30, 10, 0}, geometry::Vector3::UnitZ(), std::numbers::pi};
  const std::vector<TimedPiece> chain = {
      cut_along({0, 0, 0}, {30, 0, 0}, 6000), {arc, 3000}, cut_along({30, 20, 0}, {0, 20, 0}, 1.5)};
  for (const FeedPlanner planner : {FeedPlanner::kJerk, FeedPlanner::kSCurve}) {
    SCOPED_TRACE(name_of(planner));
    const PlannedMotion motion(chain, machine, planner);
    const std::vector<PlannedPiece> times = motion.times_of_pieces();
    double end = 0;
    for (std::size_t i = 0; i < chain.size(); ++i) {
      const PlannedPosition first = motion.position_at(end + 1e-9);
      EXPECT_EQ(first.piece, i);
      EXPECT_NEAR(first.t, 0, 1e-6);
      end += times[i].seconds;
      EXPECT_NEAR(motion.position_at(end - 1e-9).t, 1, 1e-6);
    }
    EXPECT_NEAR(motion.duration(), end, 1e-9);
    // Never back, and not faster than the feed.
    double way = 0;
    for (double time = 0; time < end; time += 0.01) {
      const PlannedPosition at = motion.position_at(time);
      double now = at.t * geometry::length_of(chain[at.piece].piece);
      for (std::size_t i = 0; i < at.piece; ++i) now += geometry::length_of(chain[i].piece);
      ASSERT_GE(now, way);
      ASSERT_LE(now - way, 1.005);
      way = now;
    }
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
