// Few arcs around the run's vertices: what plan_arc_spline promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>
#include <vector>

#include "gcode/controls/built_in.h"
#include "geometry/distance/path_distance.h"
#include "geometry/fitting/fair/fair.h"
#include "postproc/smooth/forms/output_plan.h"
#include "tests/support/paths.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

constexpr double kPi = std::numbers::pi;
constexpr double kTolerance = 0.01;

Run run_of(std::vector<Point3> points) {
  Run run;
  run.closed = points.front() == points.back();
  run.points = std::move(points);
  run.feeds = {{0, 1000}};
  return run;
}

// A circle of radius 10 in the plane across `normal`, at height 3, without a seam.
Run circle_across(int normal, int count = 300) {
  std::vector<Point3> points;
  for (int i = 0; i <= count; ++i) {
    const double angle = 2 * kPi * (i % count) / count;
    Point3 p = Point3::Zero();
    p[(normal + 1) % 3] = 10 * std::cos(angle);
    p[(normal + 2) % 3] = 10 * std::sin(angle);
    p[normal] = 3;
    points.push_back(p);
  }
  return run_of(std::move(points));
}

// y = 4 sin(x / 5), vertices every half millimetre or so.
Run arc_wave() {
  std::vector<Point3> points;
  for (int i = 0; i <= 120; ++i) points.emplace_back(0.5 * i, 4 * std::sin(0.1 * i), -1);
  return run_of(std::move(points));
}

struct PlannedArcs {
  Run run;
  geometry::SmoothCurve fair;
  std::optional<OutputPlan> plan;
};

PlannedArcs planned(Run run, double keep_corner_angle = 3.2) {
  geometry::FairOptions fair;
  fair.tolerance = kTolerance;
  fair.keep_corner_angle = keep_corner_angle;
  PlannedArcs result{run, *geometry::fair_path(run.points, fair), {}};
  PlanOptions options;
  options.target = gcode::find_control("linuxcnc");
  options.max_deviation = kTolerance;
  options.keep_corner_angle = keep_corner_angle;
  result.plan = plan_arc_spline(result.run, result.fair, options);
  return result;
}

void expect_proved(const PlannedArcs& planned) {
  geometry::Path path;
  for (const PlannedMove& move : planned.plan->moves) path.push_back(move.piece);
  EXPECT_EQ(geometry::start_point(path.front()), planned.run.points.front());
  EXPECT_EQ(geometry::end_point(path.back()), planned.run.points.back());
  const geometry::Path old_path = geometry::path_through(planned.run.points);
  EXPECT_EQ(geometry::compare_paths(old_path, path, kTolerance).verdict,
            geometry::Verdict::kProved);
}

TEST(PlanArcSpline, ACircleInEveryPlaneIsAFewArcs) {
  for (int normal = 0; normal < 3; ++normal) {
    const PlannedArcs circle = planned(circle_across(normal));
    ASSERT_TRUE(circle.plan) << normal;
    expect_proved(circle);
    EXPECT_LE(circle.plan->moves.size(), 5U);
    for (const PlannedMove& move : circle.plan->moves) {
      const auto* arc = std::get_if<geometry::Arc>(&move.piece);
      ASSERT_NE(arc, nullptr);
      EXPECT_NEAR(std::abs(arc->axis[normal]), 1, 1e-12);
      EXPECT_NEAR(arc->center[normal], 3, 1e-12);
    }
  }
}

TEST(PlanArcSpline, AClosedRunHasNoSeam) {
  const PlannedArcs circle = planned(circle_across(2));
  ASSERT_TRUE(circle.plan);
  const geometry::Vector3 first = geometry::direction_at(circle.plan->moves.front().piece, 0);
  const geometry::Vector3 last = geometry::direction_at(circle.plan->moves.back().piece, 1);
  EXPECT_LT((first - last).norm(), 1e-3);
}

TEST(PlanArcSpline, ChangesTheFeedAtItsVertexWithoutAKink) {
  postproc::Run run = arc_wave();
  run.feeds = {{0, 1000}, {50, 400}};
  const PlannedArcs wavy = planned(run);
  ASSERT_TRUE(wavy.plan);
  expect_proved(wavy);
  int changes = 0;
  const auto& moves = wavy.plan->moves;
  for (std::size_t i = 1; i < moves.size(); ++i) {
    if (moves[i].feed == moves[i - 1].feed) continue;
    ++changes;
    EXPECT_LT((geometry::start_point(moves[i].piece) - run.points[50]).norm(), 1e-9);
    const auto before = geometry::direction_at(moves[i - 1].piece, 1);
    EXPECT_LT((geometry::direction_at(moves[i].piece, 0) - before).norm(), 1e-4);
  }
  EXPECT_EQ(changes, 1);
}

TEST(PlanArcSpline, KeepsEveryCommentInOrder) {
  postproc::Run run = arc_wave();
  run.comments = {{10, {0, 1}}, {60, {1, 2}}, {60, {2, 3}}, {120, {3, 4}}};
  const PlannedArcs wavy = planned(run);
  ASSERT_TRUE(wavy.plan);
  std::vector<std::size_t> found;
  for (const PlannedMove& move : wavy.plan->moves) {
    found.insert(found.end(), move.comments_before.begin(), move.comments_before.end());
  }
  const auto& after = wavy.plan->comments_after;
  found.insert(found.end(), after.begin(), after.end());
  EXPECT_EQ(found, (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST(PlanArcSpline, AKeptCornerStandsWhereItStood) {
  std::vector<Point3> points;
  for (int i = 0; i <= 40; ++i) points.emplace_back(0.5 * i, 0, 0);
  for (int i = 1; i <= 40; ++i) {
    const double angle = -kPi / 2 + 0.05 * i;  // an arc that leaves at a right angle
    points.emplace_back(30 + 10 * std::sin(angle), 10 * std::cos(angle), 0);
  }
  const PlannedArcs kept = planned(run_of(points), 0.5);
  ASSERT_TRUE(kept.plan);
  expect_proved(kept);
  const bool stands = std::ranges::any_of(kept.plan->moves, [&](const PlannedMove& move) {
    return (geometry::end_point(move.piece) - points[40]).norm() < 1e-9;
  });
  EXPECT_TRUE(stands);
}

TEST(PlanArcSpline, PlansNothingForARunThatRises) {
  postproc::Run run = arc_wave();
  for (std::size_t i = 0; i < run.points.size(); ++i) run.points[i].z() = 0.01 * std::sin(0.3 * i);
  EXPECT_FALSE(planned(run).plan);
}

}  // namespace
}  // namespace batten::postproc
