// Flat paths for tests that come back beside their own way.
#pragma once

#include <vector>

#include "geometry/path/path.h"

namespace batten::geometry {

// Along y = 0 to x = 10, round a wide loop, and back above the first pass by `gap`.
inline std::vector<Point2> lollipop(double gap) {
  std::vector<Point2> points;
  for (int i = 0; i <= 20; ++i) points.emplace_back(0.5 * i, 0);
  points.emplace_back(12, -3);
  points.emplace_back(16, 0);
  points.emplace_back(12, 3);
  for (int i = 20; i >= 0; --i) points.emplace_back(0.5 * i, gap);
  return points;
}

// The same 0.015 above, each pass to the other side of its neighbour and back.
inline std::vector<Point2> crossing_lollipop() {
  std::vector<Point2> points = lollipop(0.015);
  points[10].y() = 0.009;
  points[34].y() = 0.006;
  return points;
}

}  // namespace batten::geometry
