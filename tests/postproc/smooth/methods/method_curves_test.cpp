// What every method promises of the curve that it makes of a run.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/joined_curve.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/smooth/methods/run_curve.h"
#include "tests/support/method_cases.h"
#include "tests/support/paths.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

CurveRequest request_with(double tolerance) {
  CurveRequest request;
  request.tolerance = tolerance;
  request.limits = limits_of(*find_machine("linuxcnc-fast"), 3000);
  return request;
}

struct NamedMethod {
  Method method;
  std::string name;
};

void PrintTo(const NamedMethod& m, std::ostream* out) { *out << m.name; }

class EveryMethod : public testing::TestWithParam<NamedMethod> {
 protected:
  [[nodiscard]] std::optional<RunCurve> curve(const std::vector<Point3>& points,
                                              const CurveRequest& request) const {
    return curve_of(GetParam().method, points, request);
  }
};

// A wavy line in space as a CAM system cuts it into chords of 0.005 mm.
std::vector<Point3> wavy() {
  return geometry::greedy_chords(
      [](double u) { return Point3(u, 2 * std::sin(u / 3), std::cos(u / 5)); }, 0.0, 20.0, 0.005, 4,
      4000);
}

std::vector<std::vector<Point3>> runs() {
  return {wavy(),
          geometry::star_path(),
          geometry::guo_hexagon(),
          geometry::ozcan_corner_path(),
          geometry::slot_path(20, 5, 40),
          geometry::circle_path(8, 90)};
}

// `deviation` is by samples with some methods: a percent is left for what lies between them.
TEST_P(EveryMethod, StaysWithinTheToleranceOfTheRunInOrder) {
  for (const double tolerance : {0.01, 0.05}) {
    for (const std::vector<Point3>& points : runs()) {
      const auto made = curve(points, request_with(tolerance));
      ASSERT_TRUE(made);
      EXPECT_LE(made->path.deviation, tolerance * (1 + 1e-6));
      const auto proof = geometry::compare_paths(
          geometry::path_through(points), geometry::beziers_of(made->path.curve), 1.03 * tolerance);
      EXPECT_EQ(proof.verdict, geometry::Verdict::kProved)
          << points.size() << " points, at most " << proof.bounds.at_most;
      EXPECT_LE(proof.bounds.at_least, made->path.deviation * 1.03 + 1e-9);
    }
  }
}

TEST_P(EveryMethod, MeetsTheEndsAndPutsTheVerticesInOrder) {
  for (std::vector<Point3> points : runs()) {
    points.insert(points.begin() + 1, points[0]);  // twice in one place
    points.push_back(points.back());
    const auto made = curve(points, request_with(0.02));
    ASSERT_TRUE(made);
    EXPECT_EQ(made->method, GetParam().method);
    const geometry::SmoothCurve& path = made->path;
    EXPECT_LT((path.curve.point_at(path.curve.first()) - points.front()).norm(), 1e-9);
    EXPECT_LT((path.curve.point_at(path.curve.last()) - points.back()).norm(), 1e-9);
    ASSERT_EQ(path.vertex_parameters.size(), points.size());
    EXPECT_TRUE(std::is_sorted(path.vertex_parameters.begin(), path.vertex_parameters.end()));
    EXPECT_EQ(path.vertex_parameters.front(), path.curve.first());
    EXPECT_EQ(path.vertex_parameters.back(), path.curve.last());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Point3 beside = path.curve.point_at(path.vertex_parameters[i]);
      EXPECT_LE((beside - points[i]).norm(), 0.0205) << i;
    }
  }
}

// The star's tips turn by 144 degrees, its dents by 72.
TEST_P(EveryMethod, LeavesCornersThatTurnMoreThanAsked) {
  const std::vector<Point3> points = geometry::star_path();
  CurveRequest request = request_with(0.05);
  request.keep_corner_angle = 100 * std::numbers::pi / 180;
  const auto made = curve(points, request);
  ASSERT_TRUE(made);
  EXPECT_EQ(made->path.kept_corners, 5);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const Point3 beside = made->path.curve.point_at(made->path.vertex_parameters[i]);
    if (i % 2 == 1) {
      EXPECT_LT((beside - points[i]).norm(), 1e-9) << "tip " << i;
    } else {
      EXPECT_GT((beside - points[i]).norm(), 1e-3) << "dent " << i;
    }
  }
}

// The middle half of a long line lies on it.
TEST_P(EveryMethod, LeavesLongLinesStraight) {
  const std::vector<Point3> points = geometry::slot_path(40, 5, 60);
  const auto made = curve(points, request_with(0.02));
  ASSERT_TRUE(made);
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if ((points[i + 1] - points[i]).norm() < 30) continue;
    for (const double part : {0.25, 0.5, 0.75}) {
      const double u0 = made->path.vertex_parameters[i];
      const double u1 = made->path.vertex_parameters[i + 1];
      const Point3 place = made->path.curve.point_at(u0 + part * (u1 - u0));
      EXPECT_NEAR(std::abs(place.y()), 5, 1e-9);
    }
  }
}

// No joint of the curve turns where the run has no kept corner.
TEST_P(EveryMethod, HasNoCornersOfItsOwn) {
  for (const std::vector<Point3>& points : {wavy(), geometry::star_path()}) {
    const auto made = curve(points, request_with(0.02));
    ASSERT_TRUE(made);
    const geometry::BsplineCurve& c = made->path.curve;
    EXPECT_TRUE(geometry::CurvePieces(c, c.first(), c.last()).corners().empty());
  }
}

// A ring that begins in a corner. Asked for, the new path goes through that point with one
// direction and one curvature; guo-literal leaves it, as its paper does.
TEST_P(EveryMethod, RoundsTheSeamOfARingWhereThatIsAsked) {
  const std::vector<Point3> square = {{0, 0, 0}, {30, 0, 0}, {30, 30, 0}, {0, 30, 0}, {0, 0, 0}};
  for (const std::vector<Point3>& ring : {square, geometry::guo_hexagon()}) {
    for (const bool asked : {false, true}) {
      CurveRequest request = request_with(0.05);
      if (asked) request.seam = geometry::Seam::kSmooth;
      const auto made = curve(ring, request);
      ASSERT_TRUE(made);
      const geometry::BsplineCurve& c = made->path.curve;
      EXPECT_LT((c.point_at(c.first()) - ring.front()).norm(), 1e-9);
      EXPECT_LT((c.point_at(c.last()) - ring.front()).norm(), 1e-9);
      const geometry::Path pieces = geometry::beziers_of(c);
      const geometry::Vector3 leaves = geometry::direction_at(pieces.front(), 0);
      const geometry::Vector3 arrives = geometry::direction_at(pieces.back(), 1);
      const bool rounded = asked && GetParam().method != Method::kGuoLiteral;
      EXPECT_EQ((leaves - arrives).norm() < 1e-9, rounded) << (leaves - arrives).norm();
      if (rounded) {
        const double bends = geometry::curvature_at(pieces.front(), 0);
        EXPECT_NEAR(geometry::curvature_at(pieces.back(), 1), bends, 1e-6 * bends);
        EXPECT_TRUE(geometry::CurvePieces(c, c.first(), c.last()).corners().empty());
      }
      EXPECT_LE(made->path.deviation, 0.05 * (1 + 1e-6));
      const auto proof = geometry::compare_paths(geometry::path_through(ring), pieces, 1.03 * 0.05);
      EXPECT_EQ(proof.verdict, geometry::Verdict::kProved) << proof.bounds.at_most;
      request.keep_corner_angle = 0.5;
      const auto kept = curve(ring, request);
      ASSERT_TRUE(kept);
      EXPECT_LT(kept->path.deviation, 1e-9) << "no corner is rounded";
    }
  }
}

TEST_P(EveryMethod, OfOnePlaceIsNothing) {
  const std::vector<Point3> points(3, Point3(1, 2, 3));
  EXPECT_FALSE(curve(points, request_with(0.01)));
}

TEST_P(EveryMethod, OfTwoPointsIsTheLine) {
  const std::vector<Point3> points = {{0, 0, 0}, {10, 5, 2}};
  const auto made = curve(points, request_with(0.01));
  ASSERT_TRUE(made);
  EXPECT_NEAR(made->path.deviation, 0, 1e-12);
  EXPECT_LT((made->path.curve.point_at(0.5 * made->path.curve.last()) - Point3(5, 2.5, 1)).norm(),
            1e-9);
}

INSTANTIATE_TEST_SUITE_P(Methods, EveryMethod,
                         testing::Values(NamedMethod{Method::kFair, "Fair"},
                                         NamedMethod{Method::kNaseath, "Naseath"},
                                         NamedMethod{Method::kNaseathLiteral, "NaseathLiteral"},
                                         NamedMethod{Method::kGuo, "Guo"},
                                         NamedMethod{Method::kGuoLiteral, "GuoLiteral"},
                                         NamedMethod{Method::kOzcanUsual, "OzcanUsual"},
                                         NamedMethod{Method::kOzcan, "Ozcan"},
                                         NamedMethod{Method::kTube, "Tube"},
                                         NamedMethod{Method::kTimeOptimal, "Racing"}),
                         [](const auto& test) { return test.param.name; });

TEST(CurveOf, RefusesWhatIsNoMethodOfItsOwn) {
  const std::vector<Point3> points = {{0, 0, 0}, {10, 5, 2}};
  for (const Method method : {Method::kBest, Method::kNone}) {
    EXPECT_THROW((void)curve_of(method, points, request_with(0.01)), std::invalid_argument);
  }
}

// What each method is for: sharp corners with the five points use all of the tolerance, the paper's
// at most half of it.
TEST(MethodCurves, OfGuoUsesAllOfTheToleranceAndTheLiteralOneHalf) {
  const std::vector<Point3> star = geometry::star_path();
  EXPECT_NEAR(curve_of(Method::kGuo, star, request_with(0.05))->path.deviation, 0.05, 1e-9);
  EXPECT_NEAR(curve_of(Method::kGuoLiteral, star, request_with(0.05))->path.deviation, 0.025, 1e-9);
}

// A wave that a fit follows within a quarter of the tolerance takes less time where the curve may
// go through all of it.
TEST(MethodCurves, OfTheTubeTakesLessTimeThanFair) {
  std::vector<Point3> points;
  for (int i = 0; i <= 160; ++i) {
    const double a = 0.05 * i;
    points.emplace_back(30 * std::cos(a / 2), 30 * std::sin(a / 2) + 0.1 * std::sin(9 * a), 0);
  }
  CurveRequest request = request_with(0.15);
  request.limits.feed = 400;
  request.limits.speed.setConstant(400);
  request.limits.acceleration.setConstant(4000);
  request.limits.jerk.setConstant(20000);
  request.jerk = 20000;
  const auto time = [&](Method method) {
    const auto made = curve_of(method, points, request);
    return plan_feed(geometry::beziers_of(made->path.curve), KinematicPathLimits(request.limits))
        .time;
  };
  const double tube = time(Method::kTube);
  EXPECT_LT(tube, 0.95 * time(Method::kFair));
  EXPECT_LE(straight_time(curve_of(Method::kTube, points, request)->path.curve, request), tube);
}

// A line with noise of 0.02 mm bends less when its control points may move by 0.08 mm.
TEST(MethodCurves, OfNaseathBendsLessThanItsFit) {
  std::vector<Point3> points;
  for (int i = 0; i <= 100; ++i) points.emplace_back(0.8 * i, 0.03 * std::sin(2.5 * i), 0);
  CurveRequest fit = request_with(0.025);
  fit.accurate = true;
  const double before = CurvatureProfile(fair_curve(points, fit)->curve).greatest();
  const double after =
      CurvatureProfile(curve_of(Method::kNaseath, points, request_with(0.1))->path.curve)
          .greatest();
  EXPECT_GT(before, 0);
  EXPECT_LT(after, 0.7 * before);
}

}  // namespace
}  // namespace batten::postproc
