#include "geometry/fitting/fewer_knots.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/path/curve_pieces.h"
#include "tests/support/knot_insertion.h"
#include "tests/support/paths.h"
#include "tests/support/random_curves.h"

namespace batten::geometry {
namespace {

// The same curve on many more knots: each span gets seven more, at uneven places.
BsplineCurve crowded(BsplineCurve curve, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> part(0.02, 0.98);
  const std::vector<double> breaks = curve.breakpoints();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (int k = 0; k < 7; ++k) {
      curve = with_knot(curve, breaks[i] + part(random) * (breaks[i + 1] - breaks[i]));
    }
  }
  return curve;
}

// A line of 20 mm, a half circle of radius 5 on the way, a line back: C1 by hand, with two knots
// where line and bend meet.
BsplineCurve hairpin() {
  const double k = 4.0 / 3 * std::tan(M_PI / 8) * 5;
  const std::vector<double> knots = {0,  0,  0,  0,  20, 20, 20, 28, 28,
                                     28, 36, 36, 36, 56, 56, 56, 56};
  const std::vector<Point3> points = {
      Point3(0, 0, 0),   Point3(20.0 / 3, 0, 0),  Point3(40.0 / 3, 0, 0),
      Point3(20, 0, 0),  Point3(20 + k, 0, 0),    Point3(25, 5 - k, 0),
      Point3(25, 5, 0),  Point3(25, 5 + k, 0),    Point3(20 + k, 10, 0),
      Point3(20, 10, 0), Point3(40.0 / 3, 10, 0), Point3(20.0 / 3, 10, 0),
      Point3(0, 10, 0)};
  return {BsplineBasis(3, knots), points};
}

// Ten waves on even knots, some thirty to each.
TEST(FewerKnots, AreAboutAsManyAsTheThirdDerivativeTells) {
  const int count = 300;
  std::vector<Point3> points;
  for (int i = 0; i < count; ++i) points.emplace_back(0.2 * i, std::sin(0.2 * M_PI * 0.2 * i), 0);
  std::vector<double> knots(4, 0.0);
  for (int i = 1; i < count - 3; ++i) knots.push_back(0.2 * i);
  knots.insert(knots.end(), 4, 0.2 * (count - 3));
  const BsplineCurve curve(BsplineBasis(3, knots), points);
  const CurvePieces pieces(curve, curve.first(), curve.last());
  double before = static_cast<double>(pieces.size());
  for (const double deviation : {0.0005, 0.002, 0.01}) {
    const auto fewer = on_fewer_knots(curve, {.max_deviation = deviation});
    ASSERT_TRUE(fewer);
    const double found = static_cast<double>(fewer->bezier_pieces().size());
    const double expected = spans_expected(pieces, deviation);
    EXPECT_GT(expected, 0.4 * found) << deviation;
    EXPECT_LT(expected, 1.3 * found) << deviation;
    EXPECT_LT(expected, before);
    before = expected;
  }
  EXPECT_THROW((void)spans_expected(pieces, 0), std::invalid_argument);
}

TEST(FewerKnots, StaysWithinTheDeviationAndMeetsTheEnds) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = crowded(tests::random_curve(seed, seed % 2 == 1), seed);
    const auto fewer = on_fewer_knots(curve, {.max_deviation = 0.005});
    if (!fewer) continue;
    EXPECT_LT(fewer->control_points().size(), curve.control_points().size());
    EXPECT_EQ(fewer->control_points().front(), curve.control_points().front());
    EXPECT_EQ(fewer->control_points().back(), curve.control_points().back());
    EXPECT_EQ(fewer->first(), curve.first());
    EXPECT_EQ(fewer->last(), curve.last());
    const PathComparison found = compare_paths(beziers_of(curve), beziers_of(*fewer), 0.0055);
    EXPECT_EQ(found.verdict, Verdict::kProved) << found.bounds.at_most;
  }
}

TEST(FewerKnots, TakesMostOfTheKnotsThatSayNothing) {
  std::size_t before = 0;
  std::size_t after = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const BsplineCurve curve = crowded(tests::random_curve(seed, true), seed);
    const auto fewer = on_fewer_knots(curve, {.max_deviation = 0.01});
    before += curve.control_points().size();
    after += (fewer ? *fewer : curve).control_points().size();
  }
  // Eight times as many spans as the curves need.
  EXPECT_LT(3 * after, before);
}

TEST(FewerKnots, KeepsLongLinesStraightAndJoinsThemSmoothly) {
  const BsplineCurve curve = crowded(hairpin(), 7);
  const auto fewer = on_fewer_knots(curve, {.max_deviation = 0.01});
  ASSERT_TRUE(fewer);
  const CurvePieces pieces(*fewer, fewer->first(), fewer->last());
  const std::vector<StraightRun> lines = pieces.straight_runs();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_NEAR(lines[0].from, 0, 1e-9);
  EXPECT_NEAR(lines[0].to, 20, 1e-9);
  EXPECT_NEAR(lines[1].from, 36, 1e-9);
  EXPECT_TRUE(pieces.corners().empty());
}

TEST(FewerKnots, KeepsCorners) {
  // Two bends that meet at a right angle in (10, 5).
  const BsplineCurve curve(BsplineBasis(3, {0, 0, 0, 0, 12, 12, 12, 24, 24, 24, 24}),
                           {Point3(0, 0, 0), Point3(4, 0, 0), Point3(8, 2, 0), Point3(10, 5, 0),
                            Point3(7, 7, 0), Point3(4, 12, 0), Point3(3, 15, 0)});
  const auto fewer = on_fewer_knots(crowded(curve, 3), {.max_deviation = 0.01});
  ASSERT_TRUE(fewer);
  const std::vector<double> corners = CurvePieces(*fewer, fewer->first(), fewer->last()).corners();
  ASSERT_EQ(corners.size(), 1U);
  EXPECT_EQ(corners[0], 12);
  EXPECT_LT((fewer->point_at(12) - Point3(10, 5, 0)).norm(), 1e-9);
}

// Elsewhere it may run ahead: only the path counts there.
TEST(FewerKnots, KeepsPlacesAlongItself) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = crowded(tests::random_curve(seed, false), seed);
    const double u = 0.37 * curve.first() + 0.63 * curve.last();
    const auto fewer = on_fewer_knots(curve, {.max_deviation = 0.005, .places = {u}});
    if (!fewer) continue;
    EXPECT_LE((fewer->point_at(u) - curve.point_at(u)).norm(), 0.0051);
  }
}

TEST(FewerKnots, SaysNothingWhereThereIsNothingToGain) {
  const BsplineCurve curve = tests::golden_curve();
  EXPECT_FALSE(on_fewer_knots(curve, {.max_deviation = 1e-4}));
}

}  // namespace
}  // namespace batten::geometry
