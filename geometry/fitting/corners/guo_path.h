// A polyline with a five-point blend (guo_corner.h) in the place of each corner.
// Method: docs/algorithms/guo.md.
#pragma once

#include <cstddef>
#include <span>
#include <variant>
#include <vector>

#include "geometry/fitting/corners/guo_corner.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// How a segment between two corners is shared.
enum class GuoSharing {
  kFair,     // half and half; the whole where the other end needs none
  kLiteral,  // the paper's: the earlier corner takes what it wants, the later what is left
};

struct GuoOptions {
  GuoRule rule;
  GuoSharing sharing = GuoSharing::kFair;
  // kLiteral only: the next blend may begin after this part of what a blend leaves of the
  // segment behind it. In [0, 1[.
  double lambda = 0;
  // The first and the last point are one place, where there is a corner as anywhere else.
  // The literal sharing has no such corner: it leaves the seam sharp.
  bool closed = false;
  double keep_corner_angle = 3.2;  // radians: vertices that turn more stay (> pi: none)
  // Radians between the legs: sharper corners are held to ToleranceKind::kPath, whatever the rule.
  double strict_sharper_than = 0;

  // The paper's routines, word for word but for the guards of degenerate corners.
  [[nodiscard]] static GuoOptions literal(double tolerance, double lambda);
};

struct GuoPathCorner {
  std::size_t vertex;  // index among the given points; 0 is the seam of a closed path
  std::variant<GuoBlend, NoBlend> outcome;
};

struct GuoPath {
  std::vector<GuoPathCorner> corners;  // in order of their vertices
  Path pieces;                         // lines and Bezier pieces, joined end to end
  std::vector<double> stations;        // mm along the polyline where they meet: see BlendedPath
};

// Points that are one place with the one before them are passed over and have no corner. A
// closed path whose seam is blended starts and ends in the middle of that blend, the place
// nearest to the vertex; any other path starts and ends at the given ends.
//
// With kFair the shares of two corners never overlap, the path reversed gives the reversed
// blends, and on a closed path no vertex is special. With kLiteral only the order of the
// joints along each segment is promised.
//
// Cost: linear. Throws std::invalid_argument when the tolerance is not a positive number or
// lambda is not in [0, 1[.
[[nodiscard]] GuoPath guo_path(std::span<const Point3> points, const GuoOptions& options);

}  // namespace batten::geometry
