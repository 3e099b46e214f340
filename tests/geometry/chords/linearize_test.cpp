#include "geometry/chords/linearize.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "geometry/chords/chord_proof.h"
#include "geometry/fitting/fair/fair.h"
#include "tests/support/curve_of.h"
#include "tests/support/parabolas.h"
#include "tests/support/surface_programs.h"

namespace batten::geometry {
namespace {

TEST(ChordVertices, AreAsManyAsTheClosedFormGives) {
  for (const ParabolaRow& row : kParabolaRows) {
    SCOPED_TRACE(row.name);
    const Parabola& parabola = row.parabola;
    const auto x = chord_vertices(parabola.curve(), parabola.from, parabola.to,
                                  {.max_deviation = row.tolerance});
    ASSERT_EQ(x.size(), row.greedy + 1);
    EXPECT_EQ(x.front(), parabola.from);
    EXPECT_EQ(x.back(), parabola.to);
    const double greatest = parabola.greatest_deviation(x);
    EXPECT_LE(greatest, row.tolerance * (1 + 1e-9));
    for (std::size_t i = 1; i < x.size() && row.greedy <= 50; ++i) {
      EXPECT_GE(parabola.deviation(x[i - 1], x[i]), 0.9 * greatest) << "chords are not balanced";
    }
  }
}

// The least deviation with as many chords, all equal, is .04921 for the four of the flat
// parabola and .039244 for the eight of the steep one.
TEST(ChordVertices, AreSpreadUntilTheLastChordIsNoRemainder) {
  for (const auto& [parabola, deviation, balanced] :
       {std::tuple{kFlatParabola, 0.05, 0.04921}, {kSteepParabola, 0.045, 0.039244}}) {
    const auto x =
        chord_vertices(parabola.curve(), parabola.from, parabola.to, {.max_deviation = deviation});
    const double greatest = parabola.greatest_deviation(x);
    EXPECT_NEAR(greatest, balanced, 0.01 * balanced);
  }
}

// What is counted before it is spread: as many chords, each as long as it may be but the last.
TEST(ChordVertices, AreAsManyBeforeTheyAreSpread) {
  for (const ParabolaRow& row : kParabolaRows) {
    SCOPED_TRACE(row.name);
    const Parabola& parabola = row.parabola;
    const auto x = chord_vertices(parabola.curve(), parabola.from, parabola.to,
                                  {.max_deviation = row.tolerance, .balanced = false});
    ASSERT_EQ(x.size(), row.greedy + 1);
    EXPECT_LE(parabola.greatest_deviation(x), row.tolerance * (1 + 1e-9));
    for (std::size_t i = 1; i + 1 < x.size() && row.greedy <= 50; ++i) {
      EXPECT_GE(parabola.deviation(x[i - 1], x[i]), 0.99 * row.tolerance);
    }
  }
}

// A stadium: two lines of 50 mm, joined by half circles of radius 5.
BsplineCurve stadium() {
  return Drawing({0, 0, 0})
      .line_to({50, 0, 0})
      .arc_about({50, 5, 0}, kPi)
      .line_to({0, 10, 0})
      .arc_about({0, 5, 0}, kPi)
      .curve();
}

TEST(ChordVertices, CoverStraightSpansWhole) {
  const auto u = chord_vertices(stadium(), 0, 10, ChordOptions{});
  for (double line_end : {0.0, 1.0, 5.0, 6.0, 10.0}) {
    EXPECT_NE(std::find(u.begin(), u.end(), line_end), u.end()) << line_end;
  }
  // One chord per line; on a half circle an angle of 2 acos(1 - 0.01 / 5) per chord: 25.
  EXPECT_EQ(u.size() - 1, 2u + 2 * 25);
}

TEST(ChordVertices, StandOnCorners) {
  const BsplineCurve corner(
      BsplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2}),
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1e-2, 0}, {3, 2e-2, 0}, {3, 3e-2, 0}});
  EXPECT_EQ(chord_vertices(corner, 0, 2, {.max_deviation = 1}), (std::vector<double>{0, 1, 2}));
}

// On curves through noise chords that hold become chords that do not when they are spread: what one
// chord is proved for is not always proved for a part of it.
TEST(ChordVertices, ComeInOrderAndHoldAlongUnevenCurves) {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    for (const auto& row : surface_rows(0.005, 0.02, seed)) {
      FairOptions fair;
      fair.tolerance = 0.01;
      fair.feed = 6000;
      const auto path = fair_path(row, fair);
      ASSERT_TRUE(path);
      const CurvePieces pieces(path->curve, path->curve.first(), path->curve.last());
      for (const double deviation : {0.0002, 0.0004, 0.0008, 0.0016}) {
        const auto u = chord_vertices(path->curve, path->curve.first(), path->curve.last(),
                                      {.max_deviation = deviation});
        EXPECT_TRUE(std::ranges::adjacent_find(u, std::greater_equal<>()) == u.end())
            << "seed " << seed << ", deviation " << deviation;
        EXPECT_EQ(u.back(), path->curve.last());
        double greatest = 0;
        for (std::size_t i = 1; i < u.size(); ++i) {
          greatest = std::max(greatest, chord_deviation(pieces, u[i - 1], u[i]));
        }
        EXPECT_LE(greatest, deviation * (1 + 1e-9)) << "seed " << seed;
      }
    }
  }
}

TEST(ChordVertices, RefuseADeviationOfZero) {
  EXPECT_THROW((void)chord_vertices(stadium(), 0, 10, ChordOptions{0}), std::invalid_argument);
}

// Signed distances of a flat curve y(x) from chords, upwards, by their lengths.
struct Offsets {
  double mean = 0;
  double rms = 0;
  double greatest = 0;
};

Offsets offsets_of(const Parabola& parabola, const std::vector<LinkVertex>& vertices) {
  Offsets found;
  double length = 0;
  // The first and the last chord have an end that stays.
  for (std::size_t i = 2; i + 1 < vertices.size(); ++i) {
    const Point3& a = vertices[i - 1].place;
    const Point3& b = vertices[i].place;
    const double part = (b - a).norm() / 500;
    for (int k = 0; k < 500; ++k) {
      const Point3 p = a + (k + 0.5) / 500 * (b - a);
      const double off = (p.y() - parabola.y(p.x())) / std::hypot(1, parabola.slope(p.x()));
      found.mean += part * off;
      found.rms += part * off * off;
      found.greatest = std::max(found.greatest, std::abs(off));
      length += part;
    }
  }
  found.mean /= length;
  found.rms = std::sqrt(found.rms / length);
  return found;
}

TEST(BalancedChords, LieAsMuchOutsideAsInside) {
  const BsplineCurve curve = kFlatParabola.curve();
  constexpr double kHeight = 0.0005;
  const std::vector<double> x = chord_vertices(curve, 2, 11, {.max_deviation = kHeight});
  std::vector<LinkVertex> on_curve;
  for (const double u : x) on_curve.push_back({curve.point_at(u), u});
  const Offsets plain = offsets_of(kFlatParabola, on_curve);
  const Offsets balanced = offsets_of(kFlatParabola, balanced_chords(curve, x));
  EXPECT_NEAR(plain.rms / plain.greatest, kChordError, 0.02);
  EXPECT_NEAR(balanced.rms / plain.rms, kBalancedError / kChordError, 0.02);
  EXPECT_LT(std::abs(balanced.mean), 0.02 * plain.rms);
  EXPECT_NEAR(balanced.greatest / plain.greatest, 2.0 / 3, 0.02);
}

// Long chords next to short ones, which balanced ones take for alike.
TEST(NearestChords, AreNearestInTheMeanSquare) {
  const BsplineCurve curve = kFlatParabola.curve();
  std::vector<double> x = {2};
  for (int i = 0; x.back() < 10.5; ++i) x.push_back(x.back() + (i % 3 == 0 ? 0.6 : 0.2));
  const std::vector<LinkVertex> nearest = nearest_chords(curve, x);
  const double rms = offsets_of(kFlatParabola, nearest).rms;
  EXPECT_LT(rms, 0.9 * offsets_of(kFlatParabola, balanced_chords(curve, x)).rms);
  for (std::size_t i = 3; i + 3 < nearest.size(); ++i) {
    for (const double off : {-2e-4, 2e-4}) {
      std::vector<LinkVertex> other = nearest;
      other[i].place.y() += off;
      EXPECT_GT(offsets_of(kFlatParabola, other).rms, rms) << "vertex " << i;
    }
  }
}

// A short rest at the end of a row: moved away from the end, which stays, it would be turned by far
// more than the row bends there.
TEST(NearestChords, LeaveAVertexBesideAnEndWhereItIsNear) {
  const BsplineCurve curve = kFlatParabola.curve();
  const std::vector<double> x = {2, 2.1, 2.6, 3.1, 3.6, 4.1, 4.3};
  const std::vector<LinkVertex> nearest = nearest_chords(curve, x);
  for (const std::size_t i : {1u, 5u}) EXPECT_EQ(nearest[i].place, curve.point_at(x[i]));
  for (const std::size_t i : {2u, 3u, 4u}) EXPECT_NE(nearest[i].place, curve.point_at(x[i]));
}

TEST(NearestChords, OfEvenOnesAreBalanced) {
  const BsplineCurve curve = kFlatParabola.curve();
  std::vector<double> x;
  for (int i = 0; i <= 40; ++i) x.push_back(2 + 0.2 * i);
  const std::vector<LinkVertex> nearest = nearest_chords(curve, x);
  const std::vector<LinkVertex> balanced = balanced_chords(curve, x);
  const double height = (balanced[20].place - curve.point_at(x[20])).norm();
  EXPECT_LT((nearest[20].place - balanced[20].place).norm(), 0.01 * height);
}

TEST(BalancedChords, EndsAndCornersStayOnTheCurve) {
  // A corner at u = 1 between two bends.
  const BsplineBasis basis(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2});
  const BsplineCurve curve(
      basis, {{0, 0, 0}, {1, 1, 0}, {2, 1, 0}, {3, 0, 0}, {4, 1, 0}, {5, 1, 0}, {6, 0, 0}});
  const std::vector<double> u = {0, 0.4, 1, 1.6, 2};
  for (const auto& vertices : {balanced_chords(curve, u), nearest_chords(curve, u)}) {
    ASSERT_EQ(vertices.size(), u.size());
    for (const std::size_t i : {0u, 2u, 4u}) EXPECT_EQ(vertices[i].place, curve.point_at(u[i]));
    for (const std::size_t i : {1u, 3u}) {
      EXPECT_GT(vertices[i].place.y(), curve.point_at(u[i]).y()) << "outwards";
      EXPECT_EQ(vertices[i].parameter, u[i]);
    }
  }
}

}  // namespace
}  // namespace batten::geometry
