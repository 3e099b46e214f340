#include "geometry/path/rational_bezier.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace batten::geometry {
namespace {

// A quarter of a circle is exact in the second degree: weights 1, sqrt(1/2), 1.
RationalBezier quarter_circle(double radius) {
  return {{weighted({radius, 0, 0}, 1), weighted({radius, radius, 0}, std::sqrt(0.5)),
           weighted({0, radius, 0}, 1)}};
}

RationalBezier random_piece(int degree, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-5, 5);
  std::uniform_real_distribution<double> weight(0.3, 3);
  RationalBezier piece;
  for (int i = 0; i <= degree; ++i) {
    piece.control.push_back(
        weighted({3.0 * i + place(random), place(random), place(random)}, weight(random)));
  }
  return piece;
}

// mm, at the same parameter of pieces that are of the same length of it.
double greatest_distance(const RationalBezier& piece, const std::vector<CubicBezier>& cubics) {
  double greatest = 0;
  const auto count = static_cast<double>(cubics.size());
  for (std::size_t i = 0; i < cubics.size(); ++i) {
    for (int k = 0; k <= 20; ++k) {
      const double t = k / 20.0;
      const Point3 on = point_at(piece, (static_cast<double>(i) + t) / count);
      greatest = std::max(greatest, (on - point_at(cubics[i], t)).norm());
    }
  }
  return greatest;
}

// So that all pieces are of the same length of the parameter.
RationalBezier part_of(const RationalBezier& piece, double from, double to) {
  // Blossom of each control point, by de Casteljau with mixed arguments.
  RationalBezier part;
  const std::size_t degree = piece.control.size() - 1;
  for (std::size_t ends = 0; ends <= degree; ++ends) {
    std::vector<WeightedPoint> d = piece.control;
    for (std::size_t level = 0; d.size() > 1; d.pop_back(), ++level) {
      const double t = level < ends ? to : from;
      for (std::size_t j = 0; j + 1 < d.size(); ++j) d[j] = (1 - t) * d[j] + t * d[j + 1];
    }
    part.control.push_back(d.front());
  }
  return part;
}

TEST(RationalBezier, IsACircleWhereItsWeightsSaySo) {
  for (int k = 0; k <= 10; ++k) {
    EXPECT_NEAR(point_at(quarter_circle(10), k / 10.0).norm(), 10, 1e-13);
  }
}

TEST(CubicPieces, AreNoFartherFromThePieceThanAsked) {
  for (const double within : {1e-3, 1e-5, 1e-7}) {
    const auto cubics = cubic_pieces(quarter_circle(10), within);
    ASSERT_TRUE(cubics);
    for (const CubicBezier& cubic : *cubics) {
      for (int k = 0; k <= 20; ++k) {
        EXPECT_NEAR(point_at(cubic, k / 20.0).norm(), 10, within + 1e-12);
      }
    }
  }
}

// The error of a cubic falls by 16 with half of its length.
TEST(CubicPieces, AreFew) {
  EXPECT_EQ(cubic_pieces(quarter_circle(10), 1e-3)->size(), 8U);
  EXPECT_EQ(cubic_pieces(quarter_circle(10), 1e-3 / 16)->size(), 16U);
  EXPECT_LE(cubic_pieces(quarter_circle(10), 1e-6)->size(), 64U);
}

// A quarter of a circle of 2 m within 1e-6 mm is the most that a curve of a program needs;
// what needs more has weights that are odd.
TEST(CubicPieces, AreNoMoreThanAPieceIsWorth) {
  EXPECT_TRUE(cubic_pieces(quarter_circle(2000), 1e-6));
  RationalBezier odd = quarter_circle(1000);
  odd.control[1] = weighted(place_of(odd.control[1]), 1e7);
  EXPECT_FALSE(cubic_pieces(odd, 1e-6));
}

TEST(CubicPieces, ChainFromItsStartToItsEnd) {
  for (int degree = 1; degree <= 5; ++degree) {
    const RationalBezier piece = random_piece(degree, 7U + static_cast<unsigned>(degree));
    const auto cubics = cubic_pieces(piece, 1e-7);
    ASSERT_TRUE(cubics) << degree;
    EXPECT_EQ(cubics->front().control[0], place_of(piece.control.front()));
    EXPECT_EQ(cubics->back().control[3], place_of(piece.control.back()));
    for (std::size_t i = 1; i < cubics->size(); ++i) {
      EXPECT_EQ((*cubics)[i - 1].control[3], (*cubics)[i].control[0]);
    }
  }
}

TEST(CubicPieces, AreNearToRandomPiecesOfEveryDegree) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const RationalBezier piece = random_piece(1 + static_cast<int>(seed % 5), seed);
    // Sixteenths, each of which is few cubics.
    for (int i = 0; i < 16; ++i) {
      const RationalBezier part = part_of(piece, i / 16.0, (i + 1) / 16.0);
      const auto cubics = cubic_pieces(part, 1e-4);
      ASSERT_TRUE(cubics);
      if (cubics->size() > 1) continue;
      EXPECT_LE(greatest_distance(part, *cubics), 1e-4) << seed;
    }
  }
}

// Without weights a cubic is its own piece.
TEST(CubicPieces, AreOneForACubic) {
  const RationalBezier piece = {{weighted({0, 0, 0}, 2), weighted({1, 5, 2}, 2),
                                 weighted({4, -3, 1}, 2), weighted({6, 1, 0}, 2)}};
  const auto cubics = cubic_pieces(piece, 1e-12);
  ASSERT_EQ(cubics->size(), 1U);
  EXPECT_LT(((*cubics)[0].control[1] - Point3(1, 5, 2)).norm(), 1e-14);
}

TEST(CubicPieces, AreNoneWhereAWeightIsNotPositive) {
  RationalBezier piece = quarter_circle(10);
  piece.control[2] = weighted({0, 10, 0}, -1);
  EXPECT_FALSE(cubic_pieces(piece, 1e-3));
}

TEST(RationalPieces, AreThoseOfTheCurveWhereAllWeightsAreOne) {
  const std::vector<Point3> points = {{0, 0, 0}, {2, 5, 1}, {4, -1, 2},
                                      {7, 3, 0}, {9, 0, 1}, {11, 2, 0}};
  const BsplineBasis basis = BsplineBasis::clamped(3, {0, 1, 2.5, 3});
  const BsplineCurve curve(basis, points);
  std::vector<WeightedPoint> heavy;
  for (const Point3& point : points) heavy.push_back(weighted(point, 1));
  const std::vector<RationalBezier> pieces = rational_pieces(basis, heavy);
  const std::vector<CubicBezier> expected = curve.bezier_pieces();
  ASSERT_EQ(pieces.size(), expected.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (int j = 0; j < 4; ++j) {
      EXPECT_LT((place_of(pieces[i].control[static_cast<std::size_t>(j)]) - expected[i].control[j])
                    .norm(),
                1e-13);
    }
  }
}

// The sum of w N P over the sum of w N.
TEST(RationalPieces, AreThoseOfRandomCurvesWithWeights) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> step(0.2, 2);
  for (int degree = 1; degree <= kMaxDegree; ++degree) {
    std::vector<double> breakpoints = {0};
    for (int i = 0; i < 5; ++i) breakpoints.push_back(breakpoints.back() + step(random));
    const BsplineBasis basis = BsplineBasis::clamped(degree, breakpoints);
    std::vector<WeightedPoint> points;
    for (std::size_t i = 0; i < basis.size(); ++i) {
      points.push_back(weighted({step(random), step(random), step(random)}, step(random)));
    }
    const std::vector<RationalBezier> pieces = rational_pieces(basis, points);
    ASSERT_EQ(pieces.size(), breakpoints.size() - 1);
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (const double t : {0.0, 0.3, 0.7, 0.99}) {
        const double u = breakpoints[i] + t * (breakpoints[i + 1] - breakpoints[i]);
        const std::size_t span = basis.find_span(u);
        std::array<double, kMaxDegree + 1> values{};
        basis.evaluate(span, u, values.data());
        WeightedPoint sum = WeightedPoint::Zero();
        const auto p = static_cast<std::size_t>(degree);
        for (std::size_t j = 0; j <= p; ++j) sum += values[j] * points[span - p + j];
        EXPECT_LT((point_at(pieces[i], t) - place_of(sum)).norm(), 1e-12) << degree << ' ' << u;
      }
    }
  }
}

// A whole circle in nine points (Piegl and Tiller 1997, The NURBS Book, ch. 7.5).
TEST(RationalPieces, AreTheQuartersOfACircle) {
  const double w = std::sqrt(0.5);
  const std::vector<std::pair<Point3, double>> square = {
      {{1, 0, 0}, 1},   {{1, 1, 0}, w},  {{0, 1, 0}, 1},  {{-1, 1, 0}, w}, {{-1, 0, 0}, 1},
      {{-1, -1, 0}, w}, {{0, -1, 0}, 1}, {{1, -1, 0}, w}, {{1, 0, 0}, 1}};
  std::vector<WeightedPoint> points;
  for (const auto& [point, weight] : square) points.push_back(weighted(10 * point, weight));
  const BsplineBasis basis(2, {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4});
  const std::vector<RationalBezier> pieces = rational_pieces(basis, points);
  ASSERT_EQ(pieces.size(), 4U);
  for (const RationalBezier& piece : pieces) {
    for (int k = 0; k <= 10; ++k) EXPECT_NEAR(point_at(piece, k / 10.0).norm(), 10, 1e-13);
  }
}

}  // namespace
}  // namespace batten::geometry
