// A knot in the middle of a blend that is off the middle by a rounding step cuts it once, not
// twice.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/path/joined_curve.h"

namespace batten::geometry {
namespace {

TEST(BlendedPath, IsCutOnceInTheMiddleOfABlend) {
  const double end = 0.3;
  const double middle = std::nextafter(0.5 * end, 1);
  const BsplineCurve blend(BsplineBasis::clamped(3, {0, middle, end}),
                           {{9, 0, 0}, {9.5, 0, 0}, {10, 0, 0}, {10, 0.5, 0}, {10, 1, 0}});
  const std::vector<Point3> corner = {{0, 0, 0}, {10, 0, 0}, {10, 10, 0}};
  const BlendedPath path = blended_path(
      corner, std::vector<std::optional<BsplineCurve>>{std::nullopt, blend, std::nullopt}, false);
  EXPECT_EQ(path.pieces.size(), 4u) << "line, two halves, line";
  for (std::size_t i = 0; i + 1 < path.stations.size(); ++i) {
    EXPECT_LT(path.stations[i], path.stations[i + 1]);
  }
  EXPECT_NO_THROW((void)curve_of_pieces(path.pieces, path.stations));
}

}  // namespace
}  // namespace batten::geometry
