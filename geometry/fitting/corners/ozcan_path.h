// A polyline with an eight-point blend (ozcan_corner.h) in the place of each corner.
// Method: docs/algorithms/ozcan.md, section Paths.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "geometry/fitting/corners/ozcan_corner.h"
#include "geometry/path/kinematic_feed.h"
#include "geometry/path/path.h"

namespace batten::geometry {

struct OzcanOptions {
  double tolerance = 0.01;  // mm
  ToleranceKind kind = ToleranceKind::kPath;
  KinematicLimits limits;
  // The first and the last point are one place, where there is a corner as anywhere else.
  bool closed = false;
  double keep_corner_angle = 3.2;  // radians: vertices that turn more stay (> pi: none)
  // Radians between the legs: sharper corners are held to ToleranceKind::kPath.
  double strict_sharper_than = 0;
  // Radians: vertices that turn less get the "usual" corner, in closed form. The feed that the
  // search would win there is little, and a smooth curve has thousands of them.
  double least_searched_turn = 0.1;
};

struct OzcanPathCorner {
  std::size_t vertex;  // index among the given points; 0 is the seam of a closed path
  std::variant<OzcanBlend, NoBlend> outcome;
};

struct OzcanPath {
  std::vector<OzcanPathCorner> corners;  // in order of their vertices
  Path pieces;                           // lines and Bezier pieces, joined end to end
  std::vector<double> stations;          // mm along the polyline where they meet: see BlendedPath
  int searched = 0;                      // corners for which an optimum was searched
};

// Segments are shared as by guo_path with kFair, and both legs of a blend are as long as the
// lesser share. Corners that are alike (half angle, legs and directions of the legs to a
// millionth) are searched once. Ends and seam as with guo_path.
//
// Cost: linear, but some 12 ms for each corner that has to be searched. Throws
// std::invalid_argument when the tolerance is not a positive number.
[[nodiscard]] OzcanPath ozcan_path(std::span<const Point3> points, const OzcanOptions& options);

}  // namespace batten::geometry
