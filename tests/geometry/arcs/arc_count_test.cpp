#include "geometry/arcs/arc_count.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/arcs/arc_fit.h"
#include "tests/support/curve_of.h"
#include "tests/support/random_curves.h"

namespace batten::geometry {
namespace {

using std::numbers::pi;
constexpr double kEndGrid = 0.001;
constexpr int kAlongZ = 2;

double arcs_counted(const BsplineCurve& curve, double deviation, int normal = kAlongZ) {
  const CurvePieces pieces(curve, curve.first(), curve.last());
  return ArcCount(pieces).within(deviation, kEndGrid, normal);
}

double arcs_found(const BsplineCurve& curve, double deviation) {
  ArcFitOptions options;
  options.max_deviation = deviation;
  options.grid = kEndGrid;
  options.helical = true;
  const auto path = fit_arcs(curve, curve.first(), curve.last(), options);
  return path ? static_cast<double>(path->size()) : 0;
}

// From a radius of 10 to one of 2 mm: its bend changes all the way.
BsplineCurve bending_spiral(double rise = 0) {
  return curve_of(
      [rise](double t) {
        const double r = 10 - 8 * t / (6 * pi);
        return Point3(r * std::cos(t), r * std::sin(t), rise * t * t);
      },
      0, 6 * pi, 300);
}

TEST(ArcCount, IsSmallForACircleAndAHelixAndNothingForALine) {
  const auto round = [](double t) { return Point3(20 * std::cos(t), 20 * std::sin(t), 0); };
  const auto helix = [](double t) { return Point3(20 * std::cos(t), 20 * std::sin(t), t); };
  EXPECT_LT(arcs_counted(curve_of(round, 0, 2 * pi, 100), 0.005), 6);
  EXPECT_LT(arcs_counted(curve_of(helix, 0, 2 * pi, 100), 0.005), 6);
  const BsplineCurve line(BsplineBasis::clamped(3, {0, 1}),
                          {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}});
  EXPECT_EQ(arcs_counted(line, 0.005), 0);
  // Along the axis nothing is seen.
  const BsplineCurve plunge(BsplineBasis::clamped(3, {0, 1}),
                            {{0, 0, 0}, {0, 0, -1}, {0, 0, -2}, {0, 0, -3}});
  EXPECT_EQ(arcs_counted(plunge, 0.005), 0);
}

// Deviations go with the cube of the length.
TEST(ArcCount, IsTwiceAsManyForAnEighthOfTheDeviation) {
  EXPECT_NEAR(arcs_counted(bending_spiral(), 0.001) / arcs_counted(bending_spiral(), 0.008), 2,
              1e-9);
}

TEST(ArcCount, IsSomewhatLessThanWhatIsFoundAlongASpiral) {
  for (const double deviation : {0.0005, 0.002, 0.008}) {
    SCOPED_TRACE(deviation);
    EXPECT_NEAR(arcs_counted(bending_spiral(), deviation) / arcs_found(bending_spiral(), deviation),
                0.75, 0.25);
  }
}

// Where the rise changes, arcs are held by it and not by their bend.
TEST(ArcCount, IsSomewhatLessThanWhatIsFoundAlongASpiralThatRises) {
  const BsplineCurve rising = bending_spiral(0.05);
  EXPECT_NEAR(arcs_counted(rising, 0.008) / arcs_found(rising, 0.008), 0.75, 0.25);
  EXPECT_GT(arcs_counted(rising, 0.008), 1.5 * arcs_counted(bending_spiral(), 0.008));
}

// Seen along another axis it is another curve: of a spiral no arcs of that plane are left.
TEST(ArcCount, SeesTheCurveAlongTheAxis) {
  EXPECT_GT(arcs_counted(bending_spiral(), 0.008, 0), 5 * arcs_counted(bending_spiral(), 0.008));
}

TEST(ArcCount, IsSeldomMoreThanWhatIsFoundAlongRandomCurves) {
  int more = 0;
  double all_counted = 0;
  double all_found = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const BsplineCurve curve = tests::random_curve(seed, seed % 2 == 1);
    const double arcs = arcs_found(curve, 0.002);
    if (arcs == 0) continue;
    const double count = arcs_counted(curve, 0.002);
    if (0.8 * count > arcs) ++more;
    all_counted += count;
    all_found += arcs;
  }
  EXPECT_LE(more, 1);
  EXPECT_NEAR(all_counted / all_found, 0.75, 0.25);
}

}  // namespace
}  // namespace batten::geometry
