#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "gcode/curves/g5_curve.h"
#include "tests/support/random_curves.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;

// A quarter circle from (r, 0) to (0, r), right to 0.0003 r.
CubicBezier quarter(double r) {
  const double k = 4.0 / 3 * std::tan(M_PI / 8) * r;
  return {{Point3(r, 0, 0), Point3(r, k, 0), Point3(k, r, 0), Point3(0, r, 0)}};
}

Point3 bezier_at(const CubicBezier& piece, double t) {
  const double s = 1 - t;
  return s * s * s * piece.control[0] + 3 * s * s * t * piece.control[1] +
         3 * s * t * t * piece.control[2] + t * t * t * piece.control[3];
}

// By brute force, from the ends alone.
double sampled_error(const CubicBezier& piece) {
  double most = 0;
  double from = 0;
  for (const double end : chopped_at(piece)) {
    const Point3 a = bezier_at(piece, from);
    const geometry::Vector3 way = bezier_at(piece, end) - a;
    for (int i = 1; i < 50; ++i) {
      const geometry::Vector3 to = bezier_at(piece, from + (end - from) * i / 50) - a;
      const double along = std::clamp(to.dot(way) / way.squaredNorm(), 0.0, 1.0);
      most = std::max(most, (to - along * way).norm());
    }
    from = end;
  }
  return most;
}

// What the algorithm of those sources gives for known curves: 0.046 to 0.052 mm for the two pieces
// of the golden curve, up to 0.066 mm for quarter circles of some radii. Their test is the sum of
// both axes at the middle of a chord, which is the distance at least.
TEST(G5Chopping, LeavesCurvesAsFarAsItIsKnownTo) {
  for (const CubicBezier& piece : tests::golden_curve().bezier_pieces()) {
    EXPECT_GE(sampled_error(piece), 0.0455);
    EXPECT_LE(sampled_error(piece), 0.0525);
  }
  double most = 0;
  for (int r = 5; r <= 200; ++r) most = std::max(most, sampled_error(quarter(r)));
  EXPECT_GE(most, 0.066);
  EXPECT_LE(most, 0.1);
}

TEST(G5Chopping, BoundsWhatIsSampled) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    for (const CubicBezier& piece : tests::random_curve(seed, true).bezier_pieces()) {
      const double sampled = sampled_error(piece);
      EXPECT_LE(sampled, chopping_error(piece) + 1e-12) << seed;
    }
  }
}

// The step starts with a tenth and never grows there.
TEST(G5Chopping, MakesTenChordsOfWhatIsShort) {
  const std::vector<double> ends = chopped_at(quarter(1));
  EXPECT_GE(ends.size(), 5U);
  EXPECT_LE(ends.size(), 11U);
  EXPECT_EQ(ends.back(), 1);
  EXPECT_TRUE(std::is_sorted(ends.begin(), ends.end()));
}

}  // namespace
}  // namespace batten::gcode
