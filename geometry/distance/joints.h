// Where two paths that follow each other pass the same place, so that they may be compared part by
// part: the distance of the wholes is no more than that of the farthest parts.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// The vertices of a path between its pieces.
struct PassedPlaces {
  std::vector<double> lengths;  // mm, of the path up to each
  // Of each; not a number where the pieces do not meet. They are looked up where they are, for
  // there are many.
  std::function<Point3(std::size_t)> place_at;

  [[nodiscard]] std::size_t size() const { return lengths.size(); }
};

struct Joint {
  std::size_t a = 0;  // pieces before it
  std::size_t b = 0;
};

// In order, each `apart` or more pieces of one of the paths behind the one before it. `a` and `b`:
// the vertices of the paths, of which the i-th is behind i + 1 pieces. Only those are joints up to
// which both paths are about as long, since a path may pass a place more than once; that two paths
// follow each other is for a comparison to find out.
[[nodiscard]] std::vector<Joint> joints_of(const PassedPlaces& a, const PassedPlaces& b,
                                           std::size_t apart);

}  // namespace batten::geometry
