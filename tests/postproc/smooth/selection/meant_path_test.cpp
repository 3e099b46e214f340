// How far moves are from the path that was meant: against what geometry says.
#include "postproc/smooth/selection/meant_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/curve_of.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

constexpr double kRadius = 10;

// Half a circle, and a run of chords whose ends are on it.
geometry::SmoothCurve half_circle(std::size_t chords, Run& run) {
  const auto f = [](double u) {
    return Point3(kRadius * std::cos(u / kRadius), kRadius * std::sin(u / kRadius), 0);
  };
  const double length = kRadius * std::numbers::pi;
  geometry::SmoothCurve circle{geometry::curve_of(f, 0, length, 400), {}, 0, 0, 0, 0};
  for (std::size_t i = 0; i <= chords; ++i) {
    const double u = length * static_cast<double>(i) / static_cast<double>(chords);
    circle.vertex_parameters.push_back(u);
    run.points.push_back(f(u));
  }
  return circle;
}

// A chord of height h is sqrt(8/15) h away (rms), whether few are looked at or some of many.
TEST(MeantPath, KnowsTheDistanceOfChords) {
  for (const std::size_t chords : {10u, 100u, 20000u}) {
    postproc::Run run;
    const geometry::SmoothCurve circle = half_circle(chords, run);
    const double half_angle = std::numbers::pi / 2 / static_cast<double>(chords);
    const double height = kRadius * (1 - std::cos(half_angle));
    const double expected = std::sqrt(8.0 / 15) * height;
    EXPECT_NEAR(MeantPath(circle).distance_of(run), expected, 0.02 * expected + 1e-9);
  }
}

// Moves beside the curve by a fifth of a millimetre, said by parameters that are a little off.
TEST(MeantPath, KnowsTheDistanceOfMovesThatWerePlannedAlongAnotherCurve) {
  postproc::Run run;
  const geometry::SmoothCurve circle = half_circle(50, run);
  geometry::SmoothCurve other = circle;
  for (double& u : other.vertex_parameters) u *= 2;
  std::vector<PlannedMove> moves;
  for (std::size_t i = 0; i + 1 < run.points.size(); ++i) {
    const Point3 from = 1.02 * run.points[i];
    const Point3 to = 1.02 * run.points[i + 1];
    geometry::Arc arc{from, to, Point3::Zero(), geometry::Vector3::UnitZ(), std::numbers::pi / 50};
    moves.push_back({arc, 1000, {}, other.vertex_parameters[i] + 0.1});
  }
  other.curve =
      geometry::curve_of([](double u) { return Point3(u, 0, 0); }, 0, 2 * circle.curve.last(), 2);
  EXPECT_NEAR(MeantPath(circle).distance_of(moves, other), 0.02 * kRadius, 1e-4);
}

// Along moves that are known: a fair curve that is off them does not count.
TEST(MeantPath, IsWhatWasKnown) {
  postproc::Run run;
  geometry::SmoothCurve off = half_circle(10, run);
  const auto z = geometry::Vector3::UnitZ();
  const Point3 middle(0, kRadius, 0);
  const double half = off.curve.last() / 2;
  const std::vector<PlannedMove> shape = {
      {geometry::Arc{run.points.front(), middle, Point3::Zero(), z, std::numbers::pi / 2},
       1000,
       {},
       0},
      {geometry::Arc{middle, run.points.back(), Point3::Zero(), z, std::numbers::pi / 2},
       1000,
       {},
       half}};
  std::vector<Point3> controls = off.curve.control_points();
  for (Point3& control : controls) control *= 1.01;
  off.curve = geometry::BsplineCurve(off.curve.basis(), controls);
  const double height = kRadius * (1 - std::cos(std::numbers::pi / 20));
  EXPECT_NEAR(MeantPath(off, shape).distance_of(run), std::sqrt(8.0 / 15) * height, 1e-3);
  EXPECT_NEAR(MeantPath(off, shape).distance_of(shape, off), 0, 1e-9);
  EXPECT_NEAR(MeantPath(off).distance_of(shape, off), 0.01 * kRadius, 1e-3);
  // Beyond the ends of an arc the nearest place is an end.
  const geometry::Line beyond{run.points.back(), run.points.back() - Point3(0, 3, 0)};
  EXPECT_NEAR(
      MeantPath(off, shape)
          .distance_of(std::vector<PlannedMove>{{beyond, 1000, {}, 0.99 * off.curve.last()}}, off),
      std::sqrt(3.0), 0.01);
}

// n chords of a half circle turn by pi / n at each of n - 1 joints.
TEST(Roughness, IsThatOfTheTurnsAtJoints) {
  postproc::Run run;
  (void)half_circle(100, run);
  std::vector<TimedPiece> moves;
  for (std::size_t i = 0; i + 1 < run.points.size(); ++i) {
    moves.push_back({geometry::Line{run.points[i], run.points[i + 1]}, 1000});
  }
  const double turn = std::numbers::pi / 100;
  const double expected = std::sqrt(99 * turn * turn / (kRadius * std::numbers::pi));
  EXPECT_NEAR(roughness_of(moves), expected, 1e-3 * expected);
  const geometry::Arc arc{run.points.front(), run.points.back(), Point3::Zero(),
                          geometry::Vector3::UnitZ(), std::numbers::pi};
  EXPECT_EQ(roughness_of(std::vector<TimedPiece>{{arc, 1000}}), 0);
  EXPECT_EQ(roughness_of({}), 0);
}

}  // namespace
}  // namespace batten::postproc
