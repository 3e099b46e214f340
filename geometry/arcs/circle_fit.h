// The circle that a path of points follows from end to end.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

struct CircleFit {
  Point2 center = Point2::Zero();
  double radius = 0;           // mm
  double rms = 0;              // mm, of the distances of all points
  std::vector<double> angles;  // radians, of each point from the first one; above 0 where the path
                               // goes round to the left. All have the same sign and grow
};

// The circle through the first point and the last one, which may be the same, that is nearest to
// all points in least squares (Gauss-Newton). Nothing for fewer than five points, where one is
// farther from it than `limit` (mm), where an edge leaves it by more, or where the points do not
// go along it in one sense, once round at most. `points`: mm.
[[nodiscard]] std::optional<CircleFit> fit_circle(std::span<const Point2> points, double limit);

}  // namespace batten::geometry
