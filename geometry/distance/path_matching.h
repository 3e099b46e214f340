// The comparison of two paths together with the certificate that proves it, for those who want to
// show where along the paths the distance is how great. Method: docs/algorithms/path_distance.md.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/distance/path_distance.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// Places that are passed together. They lie on the chords that stand for the pieces: on lines
// exactly, on arcs to within 0.5 % of the tolerance.
struct PlacePair {
  std::size_t piece_a = 0;
  std::size_t piece_b = 0;
  Point3 a = Point3::Zero();
  Point3 b = Point3::Zero();
};

struct PathMatching {
  PathComparison comparison;
  // From both starts to both ends, forward on both; between neighbours both run straight along one
  // chord. Every end of a piece of either path is in one of them. None where both paths are empty.
  std::vector<PlacePair> pairs;
};

// `comparison` is that of compare_paths. Where it is proved, the pairs are its certificate: no
// distance of a pair is above `bounds.at_most`, and the greatest is below it by the chord errors
// only, which are 1 % of the tolerance together at the most. Elsewhere they are the best matching
// that was found.
[[nodiscard]] PathMatching match_paths(std::span<const PathPiece> a, std::span<const PathPiece> b,
                                       double tolerance);

// The same for the band reading (geometry/distance/band_comparison.h): at a corner that is cut, the
// new path waits for three pairs while the old one goes round it.
[[nodiscard]] PathMatching match_in_band(std::span<const PathPiece> old_path,
                                         std::span<const PathPiece> new_path, double tolerance);

}  // namespace batten::geometry
