#include "geometry/path/path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

using std::numbers::pi;

void expect_near(const Vector3& found, const Vector3& expected, double within) {
  EXPECT_LE((found - expected).norm(), within)
      << found.transpose() << " expected " << expected.transpose();
}

PathPiece quarter_circle() {  // radius 2 about (1, 0), from (3, 0) to (1, 2)
  return Arc{{3, 0, 0}, {1, 2, 0}, {1, 0, 5}, Vector3::UnitZ(), pi / 2};
}

PathPiece helix() {  // radius 10, two turns down about X, 3 mm each
  return Arc{{0, 10, 0}, {6, 10, 0}, {-4, 0, 0}, Vector3::UnitX(), -4 * pi};
}

PathPiece spiral() {  // radius from 1 to 2 in half a turn
  return Arc{{1, 0, 0}, {-2, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), pi};
}

PathPiece cubic() { return CubicBezier{{{0, 0, 0}, {1, 2, 0}, {3, 2, 1}, {4, 0, 1}}}; }

std::vector<PathPiece> one_of_each() {
  return {Line{{1, 2, 3}, {4, 6, 3}}, quarter_circle(), helix(), spiral(), cubic()};
}

TEST(Path, PiecesMeetTheirEndsExactly) {
  for (const PathPiece& piece : one_of_each()) {
    EXPECT_EQ(point_at(piece, 0), start_point(piece));
    EXPECT_EQ(point_at(piece, 1), end_point(piece));
    expect_near(point_at(piece, 1e-9), start_point(piece), 1e-6);
    expect_near(point_at(piece, 1 - 1e-9), end_point(piece), 1e-6);
  }
}

TEST(Path, ArcsRunAboutTheirCenter) {
  const double half = std::sqrt(2.0);
  expect_near(point_at(quarter_circle(), 0.5), {1 + half, half, 0}, 1e-14);
  expect_near(direction_at(quarter_circle(), 0), {0, 1, 0}, 1e-14);
  expect_near(direction_at(quarter_circle(), 1), {-1, 0, 0}, 1e-14);
  EXPECT_NEAR(curvature_at(quarter_circle(), 0.3), 0.5, 1e-14);
  EXPECT_NEAR(length_of(quarter_circle()), pi, 1e-14);
}

// An eighth of the way a helix of two turns has turned by a quarter; clockwise about +X
// leads from +Y to -Z. Curvature r / (r^2 + c^2), c the rise per radian.
TEST(Path, HelicesRiseLinearlyInTheAngle) {
  expect_near(point_at(helix(), 0.125), {0.75, 0, -10}, 1e-13);
  const double c = 6 / (4 * pi);
  EXPECT_NEAR(curvature_at(helix(), 0.7), 10 / (100 + c * c), 1e-14);
  EXPECT_NEAR(length_of(helix()), 4 * pi * std::hypot(10, c), 1e-11);
}

// r = 1 + t, angle pi t. With x = pi (1 + t) the length is 1/pi times the integral of
// sqrt(1 + x^2) from pi to 2 pi, whose antiderivative is (x sqrt(1 + x^2) + asinh x) / 2.
TEST(Path, SpiralsChangeTheirRadiusLinearly) {
  expect_near(point_at(spiral(), 0.5), {0, 1.5, 0}, 1e-14);
  const auto f = [](double x) { return (x * std::sqrt(1 + x * x) + std::asinh(x)) / 2; };
  EXPECT_NEAR(length_of(spiral()), (f(2 * pi) - f(pi)) / pi, 1e-9);
}

TEST(Path, AFullCircleComesBack) {
  const PathPiece circle = Arc{{5, 0, 0}, {5, 0, 0}, {0, 0, 0}, Vector3::UnitZ(), -2 * pi};
  expect_near(point_at(circle, 0.25), {0, -5, 0}, 1e-14);
  EXPECT_NEAR(length_of(circle), 10 * pi, 1e-12);
}

// (t, t^2) for t in [0, 1]: curvature 2 / (1 + 4 t^2)^1.5, length (2 sqrt5 + asinh 2) / 4.
TEST(Path, BezierPiecesKnowTheParabola) {
  const PathPiece parabola =
      CubicBezier{{{0, 0, 0}, {1.0 / 3, 0, 0}, {2.0 / 3, 1.0 / 3, 0}, {1, 1, 0}}};
  expect_near(point_at(parabola, 0.3), {0.3, 0.09, 0}, 1e-15);
  EXPECT_NEAR(curvature_at(parabola, 0), 2, 1e-12);
  EXPECT_NEAR(curvature_at(parabola, 1), 2 / std::pow(5, 1.5), 1e-12);
  EXPECT_NEAR(length_of(parabola), (2 * std::sqrt(5.0) + std::asinh(2.0)) / 4, 1e-9);
  EXPECT_NEAR(second_derivative_bound(parabola), 2, 1e-12);
}

TEST(Path, LengthSurvivesACusp) {  // (t^2, t^3), speed t sqrt(4 + 9 t^2): (13^1.5 - 8) / 27
  const PathPiece cusp = CubicBezier{{{0, 0, 0}, {0, 0, 0}, {1.0 / 3, 0, 0}, {1, 1, 0}}};
  EXPECT_NEAR(length_of(cusp), (std::pow(13, 1.5) - 8) / 27, 1e-9);
}

TEST(Path, DirectionIsTakenFromTheNextTermWhereTheSpeedIsZero) {
  const PathPiece stopped = CubicBezier{{{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}}};
  expect_near(direction_at(stopped, 0), {1, 0, 0}, 1e-14);
  const PathPiece arriving = CubicBezier{{{1, 1, 0}, {1, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  expect_near(direction_at(arriving, 1), {-1, 0, 0}, 1e-14);
  const PathPiece line = CubicBezier{{{0, 0, 0}, {0, 0, 0}, {3, 4, 0}, {3, 4, 0}}};
  expect_near(direction_at(line, 1), {0.6, 0.8, 0}, 1e-14);
  const PathPiece nothing = Line{{1, 1, 1}, {1, 1, 1}};
  expect_near(direction_at(nothing, 0.5), {0, 0, 0}, 0);
}

TEST(Path, SubPiecesFollowTheWhole) {
  for (const PathPiece& piece : one_of_each()) {
    const PathPiece part = sub_piece(piece, 0.2, 0.7);
    for (double t : {0.0, 0.1, 0.5, 0.9, 1.0}) {
      expect_near(point_at(part, t), point_at(piece, 0.2 + 0.5 * t), 1e-13);
    }
  }
}

TEST(Path, ChordsStayWithinTheSecondDerivativeBound) {
  for (const PathPiece& piece : one_of_each()) {
    const double bound = second_derivative_bound(piece);
    double worst = 0;
    constexpr int kChords = 64;
    for (int i = 0; i < kChords; ++i) {
      const double t = static_cast<double>(i) / kChords;
      const double h = 1.0 / kChords;
      const Point3 middle = (point_at(piece, t) + point_at(piece, t + h)) / 2;
      const double away = (point_at(piece, t + h / 2) - middle).norm();
      EXPECT_LE(away, h * h / 8 * bound * (1 + 1e-6) + 1e-14);
      worst = std::max(worst, away);
    }
    // Tight: the bound is no more than about twice what is met somewhere.
    if (bound > 0) {
      EXPECT_GE(worst, bound / (8.0 * kChords * kChords) / 2);
    }
  }
}

TEST(Path, DirectionsAreTheDerivative) {
  for (const PathPiece& piece : one_of_each()) {
    for (double t : {0.1, 0.5, 0.9}) {
      const Vector3 step = point_at(piece, t + 1e-6) - point_at(piece, t - 1e-6);
      expect_near(direction_at(piece, t), step.normalized(), 1e-8);
    }
  }
}

TEST(Path, ChainsThroughPointsSkipRepeatedPlaces) {
  const std::vector<Point3> points = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 1e-12}, {1, 2, 0}};
  const Path path = path_through(points);
  ASSERT_EQ(path.size(), 2u);
  EXPECT_EQ(end_point(path[0]), start_point(path[1]));
  EXPECT_DOUBLE_EQ(length_of(path[0]) + length_of(path[1]), 3);
  EXPECT_TRUE(path_through({}).empty());
}

}  // namespace
}  // namespace batten::geometry
