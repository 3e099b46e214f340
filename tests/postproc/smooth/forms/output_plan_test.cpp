#include "postproc/smooth/forms/output_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>
#include <vector>

#include "gcode/controls/arc_rules.h"
#include "gcode/controls/built_in.h"
#include "tests/support/curve_of.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::BsplineCurve;
using geometry::Line;
using geometry::Point3;
using geometry::SmoothCurve;
using geometry::Vector3;

struct Smoothed {
  Run run;
  SmoothCurve fair;
};

// A run whose vertices lie on the curve, at `count` even parameters.
Smoothed smoothed(const BsplineCurve& curve, std::size_t count, double feed) {
  Smoothed result{{}, {curve, {}, 0, 0, 0, 0}};
  for (std::size_t i = 0; i < count; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(count - 1);
    const double u =
        i + 1 == count ? curve.last() : curve.first() + part * (curve.last() - curve.first());
    result.fair.vertex_parameters.push_back(u);
    result.run.points.push_back(curve.point_at(u));
  }
  result.run.feeds = {{0, feed}};
  return result;
}

// y = 5 sin(x / 5): curvature 0 to 0.2 / mm, radius 5 mm at the crests.
Smoothed wave(double feed = 1000) {
  const auto f = [](double u) { return Point3(u, 5 * std::sin(u / 5), -1); };
  return smoothed(geometry::curve_of(f, 0, 60, 600), 121, feed);
}

Machine machine_with(double block_period) {
  Machine machine;
  set_max_velocity(machine, 400);
  machine.block_period = block_period;
  return machine;
}

struct Planning {
  Machine machine = machine_with(0.001);
  PlanOptions options;
  explicit Planning(std::string_view target = "linuxcnc", Prefer prefer = Prefer::kTime) {
    options.target = gcode::find_control(target);
    options.prefer = prefer;
    options.max_deviation = 0.005;
  }
  const PlanOptions& with_machine() {
    options.machine = &machine;
    return options;
  }
};

void expect_chain(const OutputPlan& plan, const Run& run) {
  ASSERT_FALSE(plan.moves.empty());
  EXPECT_EQ(geometry::start_point(plan.moves.front().piece), run.points.front());
  EXPECT_EQ(geometry::end_point(plan.moves.back().piece), run.points.back());
  for (std::size_t i = 1; i < plan.moves.size(); ++i) {
    const Point3 start = geometry::start_point(plan.moves[i].piece);
    EXPECT_LE((start - geometry::end_point(plan.moves[i - 1].piece)).norm(), 1e-9);
  }
}

// From a place to the line from a to b.
double distance(const Point3& place, const Point3& a, const Point3& b) {
  const Vector3 along = b - a;
  if (along.squaredNorm() == 0) return (place - a).norm();
  const double t = std::clamp((place - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (place - a - t * along).norm();
}

// Greatest distance of places of the moves from the curve, found by looking at 20 places of each
// move and going along both in order.
double deviation_of(const OutputPlan& plan, const BsplineCurve& curve) {
  constexpr int kSamples = 200000;
  std::vector<Point3> samples;
  for (int i = 0; i <= kSamples; ++i) {
    samples.push_back(
        curve.point_at(curve.first() + (curve.last() - curve.first()) * i / kSamples));
  }
  double worst = 0;
  std::size_t at = 0;
  for (const PlannedMove& move : plan.moves) {
    for (int j = 0; j <= 20; ++j) {
      const Point3 place = geometry::point_at(move.piece, j / 20.0);
      while (at + 1 < samples.size() &&
             (samples[at + 1] - place).norm() <= (samples[at] - place).norm()) {
        ++at;
      }
      const Point3& near = samples[at > 0 ? at - 1 : 0];
      worst = std::max(worst, std::min(distance(place, near, samples[at]),
                                       distance(place, samples[at],
                                                samples[std::min(at + 1, samples.size() - 1)])));
    }
  }
  return worst;
}

double length_of(const PlannedMove& move) { return geometry::length_of(move.piece); }

// --- lines --------------------------------------------------------------------------------------

TEST(PlanLines, ChainsFromTheFirstPointToTheLast) {
  for (const Prefer prefer : {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize}) {
    Planning setup("linuxcnc", prefer);
    Smoothed wavy = wave();
    wavy.run.points.back() += Point3(1e-10, 0, 0);  // the run's own digits, not the curve's
    const OutputPlan plan = plan_lines(wavy.run, wavy.fair, setup.with_machine());
    EXPECT_EQ(plan.form, OutputForm::kLines);
    expect_chain(plan, wavy.run);
  }
}

TEST(PlanLines, KeepsTheDeviation) {
  for (const double feed : {100.0, 12000.0, 60000.0}) {
    for (const Prefer prefer : {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize}) {
      Planning setup("linuxcnc", prefer);
      const Smoothed wavy = wave(feed);
      const OutputPlan plan = plan_lines(wavy.run, wavy.fair, setup.with_machine());
      EXPECT_LE(deviation_of(plan, wavy.fair.curve), 0.00505) << feed;
    }
  }
}

TEST(PlanLines, SizeTakesNoMoreThanTimeAndTimeNoMoreThanAccuracy) {
  const Smoothed wavy = wave(3000);
  Planning size("linuxcnc", Prefer::kSize);
  Planning time("linuxcnc", Prefer::kTime);
  Planning accuracy("linuxcnc", Prefer::kAccuracy);
  const auto count = [&](Planning& setup) {
    return plan_lines(wavy.run, wavy.fair, setup.with_machine()).moves.size();
  };
  EXPECT_LT(count(size), count(time));
  EXPECT_LT(count(time), count(accuracy));
}

// At the crests (radius 5) a chord of deviation d is sqrt(8 * 5 * d) long: 0.316 mm at half of
// 0.005, 0.447 at all of it. At 12000 mm/min two periods of 1 ms are 0.4 mm.
TEST(PlanLines, TimeTakesHalfTheDeviationWhereTheControlHoldsTheFeed) {
  Planning setup;
  const Smoothed slow = wave(6000);  // two periods: 0.2 mm
  const OutputPlan plan = plan_lines(slow.run, slow.fair, setup.with_machine());
  const double deviation = deviation_of(plan, slow.fair.curve);
  EXPECT_LE(deviation, 0.00255);
  EXPECT_GE(deviation, 0.0020);
}

TEST(PlanLines, TimeMakesChordsLongerWhereTheControlWouldSlowDown) {
  Planning setup;
  const Smoothed fast = wave(12000);
  const OutputPlan plan = plan_lines(fast.run, fast.fair, setup.with_machine());
  std::size_t too_short = 0;
  for (const PlannedMove& move : plan.moves) too_short += length_of(move) < 0.4 ? 1 : 0;
  EXPECT_LE(too_short, plan.moves.size() / 20);
  EXPECT_GT(deviation_of(plan, fast.fair.curve), 0.0030);  // spent at the crests only
}

TEST(PlanLines, AccuracyGoesDownToATenthOfTheRounding) {
  Planning setup("grbl", Prefer::kAccuracy);  // rounding 0.0005 mm
  setup.machine = machine_with(1e-6);
  const Smoothed wavy = wave(100);
  const OutputPlan plan = plan_lines(wavy.run, wavy.fair, setup.with_machine());
  const double deviation = deviation_of(plan, wavy.fair.curve);
  EXPECT_LE(deviation, 5.2e-5);
  EXPECT_GE(deviation, 3e-5);
}

TEST(PlanLines, AccuracyIsNoFinerThanTheBlockPeriod) {
  Planning setup("linuxcnc", Prefer::kAccuracy);
  const Smoothed wavy = wave(12000);  // 0.2 mm per period
  const OutputPlan plan = plan_lines(wavy.run, wavy.fair, setup.with_machine());
  std::size_t too_short = 0;
  for (const PlannedMove& move : plan.moves) too_short += length_of(move) < 0.2 ? 1 : 0;
  EXPECT_LE(too_short, plan.moves.size() / 10);
}

TEST(PlanLines, AStraightRunIsOneLine) {
  const auto f = [](double u) { return Point3(u, 2 * u, -u / 3); };
  const Smoothed straight = smoothed(geometry::curve_of(f, 0, 50, 100), 101, 1000);
  for (const Prefer prefer : {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize}) {
    Planning setup("grbl", prefer);
    EXPECT_EQ(plan_lines(straight.run, straight.fair, setup.with_machine()).moves.size(), 1U);
  }
}

// --- feeds and comments -------------------------------------------------------------------------

TEST(PlanLines, ChangesTheFeedWhereItStood) {
  Planning setup;
  Smoothed wavy = wave();
  wavy.run.feeds = {{0, 1000}, {40, 600}, {77, 1500}};
  const OutputPlan plan = plan_lines(wavy.run, wavy.fair, setup.with_machine());
  expect_chain(plan, wavy.run);
  std::vector<std::pair<double, Point3>> changes;
  double feed = 0;
  for (const PlannedMove& move : plan.moves) {
    if (move.feed != feed) changes.emplace_back(move.feed, geometry::start_point(move.piece));
    feed = move.feed;
  }
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[1].first, 600);
  EXPECT_LT((changes[1].second - wavy.run.points[40]).norm(), 1e-9);
  EXPECT_EQ(changes[2].first, 1500);
  EXPECT_LT((changes[2].second - wavy.run.points[77]).norm(), 1e-9);
}

struct FeedCase {
  std::string name;
  std::vector<double> parameters;  // of vertices 0 ..
  std::vector<FeedFrom> feeds;
  std::vector<FeedStretch> expected;
};

class FeedStretches : public testing::TestWithParam<FeedCase> {};

TEST_P(FeedStretches, CoverTheCurve) {
  const FeedCase& test = GetParam();
  const auto f = [](double u) { return Point3(u, 0, 0); };
  Smoothed run = smoothed(geometry::curve_of(f, 0, 10, 10), test.parameters.size(), 1);
  run.fair.vertex_parameters = test.parameters;
  run.run.feeds = test.feeds;
  const auto stretches = feed_stretches(run.run, run.fair);
  ASSERT_EQ(stretches.size(), test.expected.size());
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    EXPECT_DOUBLE_EQ(stretches[i].from, test.expected[i].from);
    EXPECT_DOUBLE_EQ(stretches[i].to, test.expected[i].to);
    EXPECT_EQ(stretches[i].feed, test.expected[i].feed);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Plan, FeedStretches,
    testing::Values(
        FeedCase{"One", {0, 4, 10}, {{0, 7}}, {{0, 10, 7}}},
        FeedCase{"Two", {0, 4, 10}, {{0, 7}, {1, 8}}, {{0, 4, 7}, {4, 10, 8}}},
        FeedCase{"TheSameAgain", {0, 4, 10}, {{0, 7}, {1, 7}}, {{0, 10, 7}}},
        FeedCase{
            "ReplacedAtOnce", {0, 4, 4, 10}, {{0, 7}, {1, 8}, {2, 9}}, {{0, 4, 7}, {4, 10, 9}}},
        FeedCase{"ReplacedAtTheStart", {0, 0, 10}, {{0, 7}, {1, 8}}, {{0, 10, 8}}},
        FeedCase{"ReplacedByTheOneBefore", {0, 4, 4, 10}, {{0, 7}, {1, 8}, {2, 7}}, {{0, 10, 7}}},
        FeedCase{"OnTheLastPoint", {0, 4, 10}, {{0, 7}, {2, 8}}, {{0, 10, 7}}}),
    [](const auto& test) { return test.param.name; });

TEST(FeedStretches, NeedsAParameterForEveryPoint) {
  Smoothed wavy = wave();
  wavy.fair.vertex_parameters.pop_back();
  EXPECT_THROW((void)feed_stretches(wavy.run, wavy.fair), std::invalid_argument);
}

// Every comment stands once, before the first move that starts at or after its vertex.
TEST(PlanLines, KeepsEveryCommentAtItsPlace) {
  Planning setup;
  Smoothed wavy = wave();
  wavy.run.comments = {{1, {0, 1}}, {60, {1, 2}}, {60, {2, 3}}, {119, {3, 4}}, {120, {4, 5}}};
  const OutputPlan plan = plan_lines(wavy.run, wavy.fair, setup.with_machine());
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < plan.moves.size(); ++i) {
    for (const std::size_t comment : plan.moves[i].comments_before) {
      order.push_back(comment);
      const double vertex_x = wavy.run.points[wavy.run.comments[comment].vertex].x();
      EXPECT_GE(geometry::start_point(plan.moves[i].piece).x(), vertex_x - 1e-9);
      ASSERT_GT(i, 0U);
      EXPECT_LT(geometry::start_point(plan.moves[i - 1].piece).x(), vertex_x - 1e-9);
    }
  }
  order.insert(order.end(), plan.comments_after.begin(), plan.comments_after.end());
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(plan.comments_after.back(), 4U);
}

// --- arcs ---------------------------------------------------------------------------------------

// The wave bent in the plane whose normal is this axis.
Smoothed wave_across(int normal) {
  const auto f = [normal](double u) {
    Point3 p = Point3::Zero();
    p[(normal + 1) % 3] = u;
    p[(normal + 2) % 3] = 5 * std::sin(u / 5);
    p[normal] = 3;
    return p;
  };
  return smoothed(geometry::curve_of(f, 0, 60, 600), 121, 1000);
}

std::size_t arcs_in(const OutputPlan& plan) {
  std::size_t count = 0;
  for (const PlannedMove& move : plan.moves) count += std::holds_alternative<Arc>(move.piece);
  return count;
}

TEST(PlanArcs, TakesThePlaneThatTheRunLiesIn) {
  for (int normal = 0; normal < 3; ++normal) {
    Planning setup;
    const Smoothed wavy = wave_across(normal);
    const auto plan = plan_arcs(wavy.run, wavy.fair, setup.with_machine());
    ASSERT_TRUE(plan);
    expect_chain(*plan, wavy.run);
    EXPECT_EQ(plan->form, OutputForm::kArcs);
    EXPECT_GE(arcs_in(*plan), 10U);
    EXPECT_LE(plan->moves.size(), 60U);
    EXPECT_LE(deviation_of(*plan, wavy.fair.curve), 0.00505);
    for (const PlannedMove& move : plan->moves) {
      const auto* arc = std::get_if<Arc>(&move.piece);
      if (arc == nullptr) continue;
      EXPECT_NEAR(std::abs(arc->axis[normal]), 1, 1e-12);
    }
  }
}

TEST(PlanArcs, AccuracyIsNearer) {
  Planning time;
  Planning accuracy("linuxcnc", Prefer::kAccuracy);
  const Smoothed wavy = wave();
  const auto coarse = plan_arcs(wavy.run, wavy.fair, time.with_machine());
  const auto fine = plan_arcs(wavy.run, wavy.fair, accuracy.with_machine());
  ASSERT_TRUE(coarse && fine);
  EXPECT_LE(deviation_of(*fine, wavy.fair.curve), 0.00055);
  EXPECT_GT(fine->moves.size(), coarse->moves.size());
}

TEST(PlanArcs, WritesHelicesForARamp) {
  const double rise = -1.5 / 60;
  const auto f = [rise](double u) {
    return Point3(10 * std::cos(u / 10), 10 * std::sin(u / 10), rise * u);
  };
  Planning setup;
  const Smoothed ramp = smoothed(geometry::curve_of(f, 0, 60, 600), 121, 1000);
  const auto plan = plan_arcs(ramp.run, ramp.fair, setup.with_machine());
  ASSERT_TRUE(plan);
  expect_chain(*plan, ramp.run);
  EXPECT_GE(arcs_in(*plan), 2U);
  EXPECT_LE(plan->moves.size(), 12U);
  EXPECT_LE(deviation_of(*plan, ramp.fair.curve), 0.00505);
}

// A curve that climbs as steeply as it bends has no use for helices about any axis.
TEST(PlanArcs, PlansNothingInSpaceThatNeedsMoreMovesThanTheRunHas) {
  const auto f = [](double u) {
    return Point3(u, 5 * std::sin(u / 5), 5 * std::sin(u / 4) * std::cos(u / 7));
  };
  Planning planning;
  const Smoothed wild = smoothed(geometry::curve_of(f, 0, 60, 600), 31, 1000);
  const auto plan = plan_arcs(wild.run, wild.fair, planning.with_machine());
  EXPECT_FALSE(plan);
}

TEST(PlanArcs, PlansNoArcThatTheTargetRefuses) {
  // Spirals in until the radius is below what grbl takes.
  const auto f = [](double u) {
    const double r = 3.02 - u / 20;
    return Point3(r * std::cos(u), r * std::sin(u), 0);
  };
  Planning setup("grbl");
  const Smoothed spiral = smoothed(geometry::curve_of(f, 0, 60, 3000), 2000, 1000);
  const auto plan = plan_arcs(spiral.run, spiral.fair, setup.with_machine());
  ASSERT_TRUE(plan);
  expect_chain(*plan, spiral.run);
  EXPECT_GE(arcs_in(*plan), 20U);
  for (const PlannedMove& move : plan->moves) {
    const auto* arc = std::get_if<Arc>(&move.piece);
    if (arc == nullptr) continue;
    EXPECT_EQ(gcode::arc_refusal(*setup.options.target, *arc, gcode::Units::kMillimetre), "");
  }
  EXPECT_LE(deviation_of(*plan, spiral.fair.curve), 0.00505);
}

TEST(PlanArcs, ChangesTheFeedWhereItStoodAndKeepsComments) {
  Planning setup;
  Smoothed wavy = wave();
  wavy.run.feeds = {{0, 1000}, {40, 600}};
  wavy.run.comments = {{10, {0, 1}}, {90, {1, 2}}, {120, {2, 3}}};
  const auto plan = plan_arcs(wavy.run, wavy.fair, setup.with_machine());
  ASSERT_TRUE(plan);
  expect_chain(*plan, wavy.run);
  std::multiset<std::size_t> comments(plan->comments_after.begin(), plan->comments_after.end());
  for (std::size_t i = 0; i < plan->moves.size(); ++i) {
    const auto& before = plan->moves[i].comments_before;
    comments.insert(before.begin(), before.end());
    if (i > 0 && plan->moves[i].feed != plan->moves[i - 1].feed) {
      EXPECT_LT((geometry::start_point(plan->moves[i].piece) - wavy.run.points[40]).norm(), 1e-9);
    }
  }
  EXPECT_EQ(comments, (std::multiset<std::size_t>{0, 1, 2}));
  EXPECT_EQ(plan->moves.front().feed, 1000);
  EXPECT_EQ(plan->moves.back().feed, 600);
}

}  // namespace
}  // namespace batten::postproc
