#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "tests/support/naseath_cases.h"

namespace batten::geometry {
namespace {

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

}  // namespace
}  // namespace batten::geometry
