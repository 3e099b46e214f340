#include "postproc/smooth/forms/output_plan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <variant>
#include <vector>

#include "gcode/controls/arc_rules.h"
#include "gcode/controls/built_in.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/curve_of.h"
#include "tests/support/machine_limits.h"
#include "tests/support/paths.h"

namespace batten::postproc {
namespace {

using geometry::Arc;
using geometry::Point3;

struct Smoothed {
  Run run;
  geometry::SmoothCurve fair;
};

// A run whose vertices lie on the curve, at `count` even parameters.
Smoothed smoothed(const geometry::BsplineCurve& curve, std::size_t count, double feed) {
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
  std::string_view target = "linuxcnc";
  double chord_height = 0.005;
  double block_period = 0.001;
  double max_deviation = 0.005;
  double tolerance = 0;

  [[nodiscard]] PlanOptions options(const Machine& machine) const {
    PlanOptions options{gcode::find_control(target), &machine};
    options.chord_height = chord_height;
    options.max_deviation = max_deviation;
    options.tolerance = tolerance;
    return options;
  }
  [[nodiscard]] OutputPlan lines(const Smoothed& s) const {
    const Machine machine = machine_with(block_period);
    return plan_lines(s.run, s.fair, geometry::MarkedPieces(s.fair.curve), options(machine));
  }
  [[nodiscard]] std::optional<OutputPlan> arcs(const Smoothed& s) const {
    const Machine machine = machine_with(block_period);
    return plan_arcs(s.run, s.fair, geometry::MarkedPieces(s.fair.curve),
                     CurvatureProfile(s.fair.curve), options(machine));
  }
};

constexpr double kHeights[] = {0.0005, 0.0025, 0.006};

void expect_chain(const OutputPlan& plan, const Run& run) {
  ASSERT_FALSE(plan.moves.empty());
  EXPECT_EQ(geometry::start_point(plan.moves.front().piece), run.points.front());
  EXPECT_EQ(geometry::end_point(plan.moves.back().piece), run.points.back());
  for (std::size_t i = 1; i < plan.moves.size(); ++i) {
    const Point3 start = geometry::start_point(plan.moves[i].piece);
    EXPECT_LE((start - geometry::end_point(plan.moves[i - 1].piece)).norm(), 1e-9);
  }
}

// That of the moves and the curve, in order and both ways, proved to be within `limit`; at most
// 2 % of that too great.
double deviation_within(double limit, const OutputPlan& plan, const geometry::BsplineCurve& curve) {
  geometry::Path moves;
  for (const PlannedMove& move : plan.moves) moves.push_back(move.piece);
  const auto found = geometry::compare_paths(geometry::beziers_of(curve), moves, limit);
  EXPECT_EQ(found.verdict, geometry::Verdict::kProved) << limit;
  return found.bounds.at_most;
}

// --- lines --------------------------------------------------------------------------------------

TEST(PlanLines, ChainFromTheFirstPointToTheLastAndKeepTheDeviation) {
  for (const double feed : {100.0, 12000.0, 60000.0}) {
    Smoothed wavy = wave(feed);
    wavy.run.points.back() += Point3(1e-10, 0, 0);  // the run's own digits, not the curve's
    for (const double height : kHeights) {
      const OutputPlan plan = Planning{.chord_height = height}.lines(wavy);
      EXPECT_EQ(plan.form, Form::kLines);
      expect_chain(plan, wavy.run);
      deviation_within(0.00505, plan, wavy.fair.curve);
    }
  }
}

// Their number goes with the root of their height.
TEST(PlanLines, AreFewerTheHigherTheyAre) {
  const Smoothed wavy = wave(100);
  const auto count = [&](double height) {
    return static_cast<double>(Planning{.chord_height = height}.lines(wavy).moves.size());
  };
  EXPECT_NEAR(count(0.001) / count(0.004), 2, 0.1);
}

TEST(PlanLines, AreNoMoreThanAskedFor) {
  const Smoothed wavy = wave(100);
  const Machine machine = machine_with(0.001);
  PlanOptions options = Planning{.chord_height = 1e-4}.options(machine);
  const geometry::MarkedPieces pieces(wavy.fair.curve);
  const std::size_t many = plan_lines(wavy.run, wavy.fair, pieces, options).moves.size();
  options.most_moves = many / 2;
  const std::size_t few = plan_lines(wavy.run, wavy.fair, pieces, options).moves.size();
  EXPECT_LE(few, many / 2);
  EXPECT_GE(few, many / 3);
}

// A curve that is off its run by most of the tolerance for a third of the way leaves chords less.
TEST(PlanLines, AreFinerWhereTheCurveLeavesLessOfTheTolerance) {
  Smoothed wavy = wave(100);
  wavy.fair.edge_deviations.assign(wavy.run.points.size() - 1, 0.001);
  for (std::size_t edge = 40; edge < 80; ++edge) wavy.fair.edge_deviations[edge] = 0.0085;
  const Machine machine = machine_with(0.001);
  PlanOptions options = Planning{.chord_height = 0.01}.options(machine);
  options.tolerance = 0.01;
  const OutputPlan plan =
      plan_lines(wavy.run, wavy.fair, geometry::MarkedPieces(wavy.fair.curve), options);
  expect_chain(plan, wavy.run);
  double there = 0;
  double elsewhere = 0;
  for (const PlannedMove& move : plan.moves) {
    const double x = geometry::start_point(move.piece).x();
    double& longest = x > 20.2 && x < 39 ? there : elsewhere;
    longest = std::max(longest, geometry::length_of(move.piece));
  }
  EXPECT_LT(there, 0.6 * elsewhere);
}

// Waves that chords may pass in their middle, and vertices outside of every crest.
TEST(PlanLines, LeaveNoVertexFartherThanTheTolerance) {
  constexpr double kHeight = 0.003;
  constexpr double kOff = 0.0075;
  constexpr double kTolerance = 0.0097;
  const auto f = [](double u) { return Point3(u, kHeight * std::sin(2 * geometry::kPi * u), 0); };
  Smoothed waves = smoothed(geometry::curve_of(f, 0, 20, 400), 81, 1000);
  for (std::size_t i = 1; i < waves.run.points.size(); i += 2) {
    waves.run.points[i].y() += i % 4 == 1 ? kOff : -kOff;
  }
  waves.fair.edge_deviations.assign(waves.run.points.size() - 1, kOff);
  const OutputPlan plan = Planning{.max_deviation = 0.0018, .tolerance = kTolerance}.lines(waves);
  expect_chain(plan, waves.run);
  for (const Point3& vertex : waves.run.points) {
    double nearest = 1;
    for (const PlannedMove& move : plan.moves) {
      const auto& line = std::get<geometry::Line>(move.piece);
      nearest = std::min(nearest, geometry::distance_to_segment(vertex, line.start, line.end));
    }
    EXPECT_LE(nearest, kTolerance);
  }
}

struct Fineness {
  const char* name;
  Planning planning;
  double feed;
  double at_least;  // mm, deviation of the lines
  double at_most;
  double length;       // mm: so short a chord is ..
  std::size_t one_in;  // .. one in so many at most
};

class PlanLinesFineness : public testing::TestWithParam<Fineness> {};

TEST_P(PlanLinesFineness, IsWhatThePreferenceAndTheControlAsk) {
  const Fineness& test = GetParam();
  const Smoothed wavy = wave(test.feed);
  const OutputPlan plan = test.planning.lines(wavy);
  EXPECT_GE(deviation_within(test.at_most, plan, wavy.fair.curve), test.at_least);
  const auto too_short = std::ranges::count_if(plan.moves, [&](const PlannedMove& move) {
    return geometry::length_of(move.piece) < test.length;
  });
  EXPECT_LE(static_cast<std::size_t>(too_short), plan.moves.size() / test.one_in);
}

// At the crests (radius 5) a chord of height h is sqrt(8 * 5 * h) long: 0.316 mm at 0.0025, 0.55 at
// 0.0075. At 12000 mm/min a period of 1 ms is 0.2 mm. Balanced, two thirds of the height are left.
INSTANTIATE_TEST_SUITE_P(Plan, PlanLinesFineness,
                         testing::Values(Fineness{"WhatIsAskedForWhereTheControlHoldsTheFeed",
                                                  {.chord_height = 0.003},
                                                  6000,
                                                  0.0015,
                                                  0.0021,
                                                  0,
                                                  1},
                                         Fineness{"MoreAtTheCrestsWhereItWouldSlowDown",
                                                  {.chord_height = 0.0005},
                                                  12000,
                                                  0.0003,
                                                  0.00505,
                                                  0.2,
                                                  10}),
                         [](const auto& test) { return test.param.name; });

// Vertices of a curve, 3 mm apart: chords 0.2 mm high at the crests, where two thirds of it are
// more than may be.
TEST(PlanVertices, AreMovedByNoMoreThanAskedForAndHaveTheirFeeds) {
  Smoothed s = wave();
  Smoothed coarse{{}, {s.fair.curve, {}, 0, 0, 0, 0}};
  for (std::size_t i = 0; i < s.run.points.size(); i += 6) {
    coarse.run.points.push_back(s.run.points[i]);
    coarse.fair.vertex_parameters.push_back(s.fair.vertex_parameters[i]);
  }
  coarse.run.feeds = {{0, 1000}, {4, 500}, {9, 800}};
  const auto& points = coarse.run.points;
  double before = 0;
  for (const double most : {0.02, 0.05, 1.0}) {
    const Machine machine = machine_with(0.001);
    const PlanOptions options = Planning{.max_deviation = most}.options(machine);
    const OutputPlan plan = plan_vertices(coarse.run, coarse.fair, options);
    ASSERT_EQ(plan.moves.size(), points.size() - 1);
    double farthest = 0;
    for (std::size_t i = 0; i < plan.moves.size(); ++i) {
      const auto& line = std::get<geometry::Line>(plan.moves[i].piece);
      farthest = std::max(farthest, (line.start - points[i]).norm());
      EXPECT_EQ(plan.moves[i].feed, i < 4 ? 1000 : i < 9 ? 500 : 800) << i;
      if (i == 0) continue;
      EXPECT_EQ(line.start, geometry::end_point(plan.moves[i - 1].piece));
    }
    EXPECT_EQ(geometry::start_point(plan.moves.front().piece), points.front());
    EXPECT_EQ(geometry::end_point(plan.moves.back().piece), points.back());
    EXPECT_LE(farthest, most * (1 + 1e-9));
    EXPECT_GT(farthest, before);
    before = farthest;
  }
}

TEST(PlanLines, AStraightRunIsOneLine) {
  const auto f = [](double u) { return Point3(u, 2 * u, -u / 3); };
  const Smoothed straight = smoothed(geometry::curve_of(f, 0, 50, 100), 101, 1000);
  for (const double height : kHeights) {
    EXPECT_EQ((Planning{"grbl", height}.lines(straight).moves.size()), 1U);
  }
}

// --- feeds and comments -------------------------------------------------------------------------

TEST(PlanLines, ChangesTheFeedWhereItChanged) {
  Smoothed wavy = wave();
  wavy.run.feeds = {{0, 1000}, {40, 600}, {77, 1500}};
  const OutputPlan plan = Planning().lines(wavy);
  expect_chain(plan, wavy.run);
  std::size_t next = 0;
  double feed = 0;
  for (const PlannedMove& move : plan.moves) {
    if (move.feed == feed) continue;
    feed = move.feed;
    ASSERT_LT(next, wavy.run.feeds.size());
    EXPECT_EQ(feed, wavy.run.feeds[next].feed);
    const Point3& vertex = wavy.run.points[wavy.run.feeds[next].vertex];
    EXPECT_LT((geometry::start_point(move.piece) - vertex).norm(), 1e-9);
    ++next;
  }
  EXPECT_EQ(next, 3U);
}

struct FeedCase {
  std::string name;
  std::vector<double> parameters;  // of vertices 0 ..
  std::vector<FeedFrom> feeds;
  std::vector<FeedSection> expected;
};

class FeedSections : public testing::TestWithParam<FeedCase> {};

TEST_P(FeedSections, CoverTheCurve) {
  const FeedCase& test = GetParam();
  const auto f = [](double u) { return Point3(u, 0, 0); };
  Smoothed run = smoothed(geometry::curve_of(f, 0, 10, 10), test.parameters.size(), 1);
  run.fair.vertex_parameters = test.parameters;
  run.run.feeds = test.feeds;
  const auto sections = feed_sections(run.run, run.fair);
  ASSERT_EQ(sections.size(), test.expected.size());
  for (std::size_t i = 0; i < sections.size(); ++i) {
    EXPECT_DOUBLE_EQ(sections[i].from, test.expected[i].from);
    EXPECT_DOUBLE_EQ(sections[i].to, test.expected[i].to);
    EXPECT_EQ(sections[i].feed, test.expected[i].feed);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Plan, FeedSections,
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

TEST(FeedSections, NeedsAParameterForEveryPoint) {
  Smoothed wavy = wave();
  wavy.fair.vertex_parameters.pop_back();
  EXPECT_THROW((void)feed_sections(wavy.run, wavy.fair), std::invalid_argument);
}

// Every comment is there once, before the first move that starts at or after its vertex.
TEST(PlanLines, KeepsEveryCommentAtItsVertex) {
  Smoothed wavy = wave();
  wavy.run.comments = {{1, {0, 1}, true},
                       {60, {1, 2}, true},
                       {61, {2, 3}},
                       {119, {3, 4}, true},
                       {120, {4, 5}, true}};
  const OutputPlan plan = Planning().lines(wavy);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < plan.moves.size(); ++i) {
    for (const std::size_t comment : plan.moves[i].comments_before) {
      order.push_back(comment);
      const CommentAt& at = wavy.run.comments[comment];
      const double vertex_x = wavy.run.points[at.vertex - (at.behind_words ? 0 : 1)].x();
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
    const Smoothed wavy = wave_across(normal);
    const auto plan = Planning().arcs(wavy);
    ASSERT_TRUE(plan);
    expect_chain(*plan, wavy.run);
    EXPECT_EQ(plan->form, Form::kArcs);
    EXPECT_GE(arcs_in(*plan), 10U);
    EXPECT_LE(plan->moves.size(), 60U);
    deviation_within(0.00505, *plan, wavy.fair.curve);
    for (const PlannedMove& move : plan->moves) {
      const auto* arc = std::get_if<Arc>(&move.piece);
      if (arc == nullptr) continue;
      EXPECT_NEAR(std::abs(arc->axis[normal]), 1, 1e-12);
    }
  }
}

TEST(PlanArcs, AreMoreTheNearerTheyAre) {
  const Smoothed wavy = wave();
  const auto coarse = Planning().arcs(wavy);
  const auto fine = Planning{.max_deviation = 0.0005}.arcs(wavy);
  ASSERT_TRUE(coarse && fine);
  deviation_within(0.00055, *fine, wavy.fair.curve);
  EXPECT_GT(fine->moves.size(), coarse->moves.size());
}

TEST(PlanArcs, WritesHelicesForARamp) {
  const double rise = -1.5 / 60;
  const auto f = [rise](double u) {
    return Point3(10 * std::cos(u / 10), 10 * std::sin(u / 10), rise * u);
  };
  const Smoothed ramp = smoothed(geometry::curve_of(f, 0, 60, 600), 121, 1000);
  const auto plan = Planning().arcs(ramp);
  ASSERT_TRUE(plan);
  expect_chain(*plan, ramp.run);
  EXPECT_GE(arcs_in(*plan), 2U);
  EXPECT_LE(plan->moves.size(), 12U);
  deviation_within(0.00505, *plan, ramp.fair.curve);
}

// A curve that climbs as steeply as it bends has no use for helices about any axis.
TEST(PlanArcs, PlansNothingInSpaceThatNeedsMoreMovesThanTheRunHas) {
  const auto f = [](double u) {
    return Point3(u, 5 * std::sin(u / 5), 5 * std::sin(u / 4) * std::cos(u / 7));
  };
  EXPECT_FALSE(Planning().arcs(smoothed(geometry::curve_of(f, 0, 60, 600), 31, 1000)));
}

TEST(PlanArcs, PlansNoArcThatTheTargetRefuses) {
  // Spirals in until the radius is below what grbl takes; the parameter is about the length.
  constexpr double kOuter = 3.02;
  constexpr double kInwards = 0.05;  // mm per radian
  const auto f = [](double u) {
    const double r = std::sqrt(kOuter * kOuter - 2 * kInwards * u);
    const double angle = (kOuter - r) / kInwards;
    return Point3(r * std::cos(angle), r * std::sin(angle), 0);
  };
  const Smoothed spiral = smoothed(geometry::curve_of(f, 0, 91.12, 3000), 2000, 1000);
  constexpr double kTolerance = 0.008;  // 0.003 more than the arcs may be from the curve
  const auto plan = Planning{.target = "grbl", .tolerance = kTolerance}.arcs(spiral);
  ASSERT_TRUE(plan);
  expect_chain(*plan, spiral.run);
  EXPECT_GE(arcs_in(*plan), 20U);
  for (const PlannedMove& move : plan->moves) {
    const auto* arc = std::get_if<Arc>(&move.piece);
    if (arc == nullptr) continue;
    EXPECT_EQ(gcode::arc_refusal(*gcode::find_control("grbl"), *arc, gcode::Units::kMillimetre),
              "");
    EXPECT_LE(gcode::chord_error(gcode::find_control("grbl")->chords, *arc), kTolerance);
  }
  deviation_within(kTolerance + 0.00005, *plan, spiral.fair.curve);
  // Where there is nothing for the chords of the control, they are chords of ours.
  const auto lines = Planning{"grbl"}.arcs(spiral);
  EXPECT_TRUE(!lines || (arcs_in(*lines) == 0 && lines->arcs_as_chords));
}

TEST(PlanArcs, ChangesTheFeedWhereItChangedAndKeepsComments) {
  Smoothed wavy = wave();
  wavy.run.feeds = {{0, 1000}, {40, 600}};
  wavy.run.comments = {{10, {0, 1}}, {90, {1, 2}}, {120, {2, 3}}};
  const auto plan = Planning().arcs(wavy);
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
