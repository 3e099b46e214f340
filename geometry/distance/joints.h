// Where two paths that follow each other pass the same place, so that they may be compared part by
// part: the distance of the wholes is no more than that of the farthest parts.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// A vertex of a path between two of its pieces.
struct PassedPlace {
  Point3 place;       // not a number where the pieces do not meet
  double length = 0;  // mm, of the path up to there
};

struct Joint {
  std::size_t a = 0;  // pieces before it
  std::size_t b = 0;
};

// In order, each `apart` or more pieces of one of the paths behind the one before it. `a` and `b`:
// the vertices of the paths, of which the i-th is behind i + 1 pieces. Only those are joints up to
// which both paths are about as long, since a path may pass a place more than once; that two paths
// follow each other is for a comparison to find out.
[[nodiscard]] std::vector<Joint> joints_of(std::span<const PassedPlace> a,
                                           std::span<const PassedPlace> b, std::size_t apart);

}  // namespace batten::geometry
