#include "geometry/path/bspline_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/curve_of.h"
#include "tests/support/knot_insertion.h"
#include "tests/support/naseath_cases.h"

namespace batten::geometry {
namespace {

// The planar test curve of docs/controllers: points given at five parameters.
BsplineCurve golden_curve() {
  return {BsplineBasis(3, {0, 0, 0, 0, 0.4, 1, 1, 1, 1}),
          {{0, 0, 0}, {10, 0, 0}, {20, 10, 0}, {30, 10, 0}, {40, 0, 0}}};
}

BsplineCurve random_curve(int seed, int degree, std::size_t size) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-1, 1);
  std::uniform_real_distribution<double> width(0.05, 1);
  std::vector<double> breakpoints = {0};
  while (breakpoints.size() + degree - 1 < size) {
    breakpoints.push_back(breakpoints.back() + width(random));
  }
  std::vector<Point3> points;
  for (std::size_t i = 0; i < size; ++i) {
    points.emplace_back(place(random), place(random), place(random));
  }
  return {BsplineBasis::clamped(degree, breakpoints), points};
}

void expect_close(const Point3& a, const Point3& b, double within) {
  EXPECT_LE((a - b).norm(), within) << a.transpose() << " and " << b.transpose();
}

TEST(BsplineCurve, MeetsTheGivenPlacesOfTheGoldenCurve) {
  const BsplineCurve curve = golden_curve();
  expect_close(curve.point_at(0.2), {11.25, 2.3, 0}, 1e-12);
  expect_close(curve.point_at(0.4), {18, 6.4, 0}, 1e-12);
  expect_close(curve.point_at(0.55), {22.5625, 8.325, 0}, 1e-12);
  expect_close(curve.point_at(0.7), {27.5, 8.3, 0}, 1e-12);
  expect_close(curve.point_at(0.85), {33.1875, 5.725, 0}, 1e-12);
}

TEST(BsplineCurve, CutsTheGoldenCurveIntoItsBezierPieces) {
  const auto pieces = golden_curve().bezier_pieces();
  ASSERT_EQ(pieces.size(), 2u);
  const double xs[2][4] = {{0, 10, 14, 18}, {18, 24, 30, 40}};
  const double ys[2][4] = {{0, 0, 4, 6.4}, {6.4, 10, 10, 0}};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 4; ++j) {
      expect_close(pieces[i].control[j], {xs[i][j], ys[i][j], 0}, 1e-12);
    }
  }
}

TEST(BsplineCurve, DerivativesAreTheLimitsOfDifferences) {
  for (int seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_curve(seed, 3 + seed % 3, 9);
    const double u = 0.37 * curve.last();
    constexpr double kStep = 1e-5;
    for (int order = 1; order <= 3; ++order) {
      const Vector3 before = curve.derivative_at(u - kStep, order - 1);
      const Vector3 after = curve.derivative_at(u + kStep, order - 1);
      const Vector3 difference = (after - before) / (2 * kStep);
      const Vector3 exact = curve.derivative_at(u, order);
      // The third derivative of a cubic jumps at knots; the span of u holds both steps but
      // for rare seeds, where the difference is between two values.
      EXPECT_LE((difference - exact).norm(), 1e-3 * (1 + exact.norm())) << "order " << order;
    }
  }
}

TEST(BsplineCurve, ANewKnotDoesNotMoveTheCurve) {
  for (int seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_curve(seed, 1 + seed % 5, 9);
    const BsplineCurve refined = with_knot(curve, 0.41 * curve.last());
    ASSERT_EQ(refined.control_points().size(), curve.control_points().size() + 1);
    for (int i = 0; i <= 40; ++i) {
      const double u = curve.last() * i / 40;
      expect_close(refined.point_at(u), curve.point_at(u), 1e-12);
      EXPECT_LE(curve.point_at(u).cwiseAbs().maxCoeff(), 1 + 1e-12) << "the control points' box";
    }
  }
}

TEST(BsplineCurve, APartIsTheSameCurve) {
  for (int seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_curve(seed, 1 + seed % 5, 12);
    const std::vector<double> knots = curve.breakpoints();
    const double from = seed % 2 == 0 ? knots[1] : 0.13 * curve.last();
    const double to = seed % 3 == 0 ? curve.last() : 0.77 * curve.last();
    const BsplineCurve part = curve.part(from, to);
    EXPECT_EQ(part.first(), from);
    EXPECT_EQ(part.last(), to);
    for (int i = 0; i <= 40; ++i) {
      const double u = from + (to - from) * i / 40;
      expect_close(part.point_at(u), curve.point_at(u), 1e-11);
    }
  }
}

TEST(BsplineCurve, BezierPiecesAreTheCurve) {
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_curve(seed, 1 + seed % 3, 10);
    const auto pieces = curve.bezier_pieces();
    const auto knots = curve.breakpoints();
    ASSERT_EQ(pieces.size(), knots.size() - 1);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (const double t : {0.0, 0.25, 0.6, 1.0}) {
        const double s = 1 - t;
        const auto& b = pieces[i].control;
        const Point3 there =
            s * s * s * b[0] + 3 * s * s * t * b[1] + 3 * s * t * t * b[2] + t * t * t * b[3];
        expect_close(there, curve.point_at(knots[i] + t * (knots[i + 1] - knots[i])), 1e-12);
      }
    }
  }
}

TEST(BsplineCurve, KnowsTheCurvatureAndLengthOfAParabola) {
  // (t, t^2) on [0, 1] as a cubic: curvature 2 / (1 + 4 t^2)^1.5, length by the closed form
  // sqrt(5)/2 + asinh(2)/4.
  const BsplineCurve curve(BsplineBasis::clamped(3, {0, 1}),
                           {{0, 0, 0}, {1.0 / 3, 0, 0}, {2.0 / 3, 1.0 / 3, 0}, {1, 1, 0}});
  for (const double t : {0.0, 0.3, 1.0}) {
    EXPECT_NEAR(curve.curvature_at(t), 2 / std::pow(1 + 4 * t * t, 1.5), 1e-12);
  }
  EXPECT_NEAR(length_between(curve, 0, 1), std::sqrt(5.0) / 2 + std::asinh(2.0) / 4, 1e-5);
}

TEST(BsplineCurve, HasADirectionWhereItsSpeedVanishes) {
  const BsplineCurve curve(BsplineBasis::clamped(3, {0, 1}),
                           {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1, 0, 0}});
  expect_close(curve.direction_at(0), {1, 0, 0}, 1e-12);
  expect_close(curve.direction_at(1), {1, 0, 0}, 1e-12);
}

TEST(BsplineCurve, RefusesAWrongNumberOfControlPoints) {
  try {
    const BsplineCurve curve(BsplineBasis::clamped(3, {0, 1}), {{0, 0, 0}, {1, 0, 0}});
    FAIL() << "accepted " << curve.control_points().size() << " control points";
  } catch (const std::invalid_argument& problem) {
    EXPECT_STREQ(problem.what(), "BsplineCurve: 2 control points, expected 4 (knots - degree - 1)");
  }
}

TEST(BsplineBasis, SumsToOneAndItsDerivativesToZero) {
  for (int seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineBasis basis = random_curve(seed, 1 + seed % 5, 10).basis();
    const double u = basis.last() * (seed % 11) / 10;
    double values[6 * 6];
    basis.evaluate_derivatives(basis.find_span(u), u, 2, values);
    const int stride = basis.degree() + 1;
    for (int d = 0; d <= 2; ++d) {
      double sum = 0;
      double size = 1;
      for (int j = 0; j < stride; ++j) {
        sum += values[d * stride + j];
        size += std::abs(values[d * stride + j]);
      }
      EXPECT_NEAR(sum, d == 0 ? 1 : 0, 1e-13 * size);
    }
  }
}

TEST(BsplineBasis, GrevilleAbscissaeReproduceTheParameter) {
  const BsplineBasis basis = random_curve(3, 3, 10).basis();
  std::vector<Point3> points;
  for (std::size_t i = 0; i < basis.size(); ++i) points.emplace_back(basis.greville(i), 0, 0);
  const BsplineCurve line(basis, points);
  for (int i = 0; i <= 20; ++i) {
    const double u = basis.last() * i / 20;
    EXPECT_NEAR(line.point_at(u).x(), u, 1e-12);
  }
}

TEST(BsplineBasis, FindsTheSpanOfKnotsAndEnds) {
  const BsplineBasis basis(3, {0, 0, 0, 0, 1, 1, 2, 3, 3, 3, 3});
  EXPECT_EQ(basis.find_span(-1), 3u);
  EXPECT_EQ(basis.find_span(0), 3u);
  EXPECT_EQ(basis.find_span(1), 5u);
  EXPECT_EQ(basis.find_span(2.5), 6u);
  EXPECT_EQ(basis.find_span(3), 6u);
}

TEST(DisplacementBounds, OfOneMovedPointIsItsGreatestShare) {
  // On uniform knots far from the ends one point has at most 2/3 of the curve, at its own knot,
  // and 1/6 at the two knots beside it.
  std::vector<Point3> moves(11, Point3::Zero());
  moves[5] = Vector3(0, 3, 4);
  const auto bounds = displacement_bounds(uniform_cubic(moves), 1e-9);
  ASSERT_EQ(bounds.size(), 8u);
  const double expected[] = {0, 0, 5.0 / 6, 10.0 / 3, 10.0 / 3, 5.0 / 6, 0, 0};
  for (std::size_t i = 0; i < bounds.size(); ++i) EXPECT_NEAR(bounds[i], expected[i], 2e-9);
}

TEST(DisplacementBounds, HoldEverywhereAndAreTight) {
  constexpr double kSlack = 1e-4;
  for (int seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::normal_distribution<double> size(0, 1);
    std::vector<Point3> moves;
    for (int i = 0; i < 9; ++i) moves.emplace_back(size(random), size(random), size(random));
    const BsplineCurve displacement = uniform_cubic(moves);
    const auto bounds = displacement_bounds(displacement, kSlack);
    for (std::size_t span = 0; span < bounds.size(); ++span) {
      double most = 0;
      for (int i = 0; i <= 2000; ++i) {
        const double u = static_cast<double>(span) + i / 2000.0;
        most = std::max(most, displacement.point_at(u).norm());
      }
      EXPECT_GE(bounds[span], most - 1e-12);
      EXPECT_LE(bounds[span], most + kSlack + 1e-5);  // 1e-5: what the samples miss
    }
  }
}

// Whatever the spans are: the first and second derivatives agree where it begins and ends, and the
// ring that begins a point later is the same curve.
TEST(RingOf, HasNoSeamWhereverItBegins) {
  const std::vector<double> breakpoints = {0, 1, 2.5, 3, 5, 5.5};
  const std::vector<Point3> points = {{0, 0, 0}, {4, -1, 1}, {6, 3, 0}, {2, 6, -1}, {-2, 3, 2}};
  const BsplineCurve ring = ring_of(breakpoints, points);
  EXPECT_LE((ring.point_at(0) - ring.point_at(5.5)).norm(), 1e-14);
  EXPECT_LE((ring.derivative_at(0, 1) - ring.derivative_at(5.5, 1)).norm(), 1e-12);
  EXPECT_LE((ring.derivative_at(0, 2) - ring.derivative_at(5.5, 2)).norm(), 1e-12);
  const BsplineCurve later =
      ring_of({1, 2.5, 3, 5, 5.5, 6.5}, {points[1], points[2], points[3], points[4], points[0]});
  for (int i = 0; i <= 50; ++i) {
    const double u = 1 + 0.11 * i;
    EXPECT_LE((later.point_at(u) - ring.point_at(u > 5.5 ? u - 5.5 : u)).norm(), 1e-13) << u;
  }
  // On even spans the curve begins at (P4 + 4 P0 + P1) / 6.
  const BsplineCurve even = ring_of({0, 1, 2, 3, 4, 5}, points);
  EXPECT_LE((even.point_at(0) - (points[4] + 4 * points[0] + points[1]) / 6).norm(), 1e-14);
  EXPECT_THROW((void)ring_of({0, 1, 2, 3, 4}, points), std::invalid_argument);
  EXPECT_THROW((void)ring_of({0, 1, 2, 2, 4, 5}, points), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
