// Blends side by side make one path whose stations go forward, whatever noise their ends have.

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/path/joined_curve.h"

namespace batten::geometry {
namespace {

// A cubic from `start` to `end` that is pulled towards the vertex between them.
BsplineCurve blend_between(const Point3& start, const Point3& vertex, const Point3& end) {
  return {BsplineBasis::clamped(3, {0, 1}),
          {start, (start + 2 * vertex) / 3, (end + 2 * vertex) / 3, end}};
}

class BlendsOnOneLeg : public testing::TestWithParam<double> {};

// Both blends are to end in the middle of the leg from (10, 0) to (10, 10); the first one misses
// it by the parameter, backwards, not at all, or too far.
TEST_P(BlendsOnOneLeg, GoForwardAlongThePolyline) {
  const std::vector<Point3> points = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}, {20, 10, 0}};
  std::vector<std::optional<BsplineCurve>> blends(points.size());
  blends[1] = blend_between({5, 0, 0}, points[1], {10, 5 + GetParam(), 0});
  blends[2] = blend_between({10, 5, 0}, points[2], {15, 10, 0});
  const BlendedPath path = blended_path(points, blends);
  ASSERT_EQ(path.stations.size(), path.pieces.size() + 1);
  for (std::size_t i = 0; i + 1 < path.stations.size(); ++i) {
    EXPECT_LT(path.stations[i], path.stations[i + 1]) << i;
  }
  EXPECT_EQ(path.stations.front(), 0);
  EXPECT_NEAR(path.stations.back(), 30, 1e-12);
  for (std::size_t i = 0; i + 1 < path.pieces.size(); ++i) {
    EXPECT_EQ(end_point(path.pieces[i]), start_point(path.pieces[i + 1])) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(BlendedPath, BlendsOnOneLeg,
                         testing::Values(-1e-3, -1e-8, -1e-10, 0.0, 1e-10, 1e-8, 1e-6));

// A knot in the middle of a blend that is off the middle by a rounding step cuts it once, not
// twice.
TEST(BlendedPath, IsCutOnceInTheMiddleOfABlend) {
  const double end = 0.3;
  const double middle = std::nextafter(0.5 * end, 1);
  const BsplineCurve blend(BsplineBasis::clamped(3, {0, middle, end}),
                           {{9, 0, 0}, {9.5, 0, 0}, {10, 0, 0}, {10, 0.5, 0}, {10, 1, 0}});
  const std::vector<Point3> corner = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  const BlendedPath path = blended_path(
      corner, std::vector<std::optional<BsplineCurve>>{std::nullopt, blend, std::nullopt});
  EXPECT_EQ(path.pieces.size(), 4u) << "line, two halves, line";
  for (std::size_t i = 0; i + 1 < path.stations.size(); ++i) {
    EXPECT_LT(path.stations[i], path.stations[i + 1]);
  }
  EXPECT_NO_THROW((void)curve_of_pieces(path.pieces, path.stations));
}

}  // namespace
}  // namespace batten::geometry
