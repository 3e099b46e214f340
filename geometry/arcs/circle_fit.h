// The circle that a path of points follows from end to end.
#pragma once

#include <cstddef>
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

constexpr std::size_t kFewestOnCircle = 5;  // points

struct CircleLimits {
  double off = 0;    // mm: points from the circle, at most
  double chord = 0;  // mm: edges from it, at most
};

// The circle through the first point and the last one, which may be the same, that is nearest to
// all points in least squares (Gauss-Newton). Nothing for fewer than kFewestOnCircle points, where
// one of them or an edge is farther from it than these limits, or where the points do not go along
// it in one sense, once round at most. `points`: mm.
[[nodiscard]] std::optional<CircleFit> fit_circle(std::span<const Point2> points,
                                                  const CircleLimits& limits);

}  // namespace batten::geometry
