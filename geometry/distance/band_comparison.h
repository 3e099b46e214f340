// Proved bounds on the distance of two paths in the band reading of a tolerance.
// Method: docs/algorithms/path_distance.md, section The band reading.
//
// What is promised. kProved: the paths have a matching in order, in which neither steps back and
// all matched pairs are within the tolerance, except that at some points n of the new path the
// matching waits while the old path goes round a corner V of two lines, from A on the one to B on
// the other. A and B are within the tolerance of n, and V is within the tolerance divided by the
// sine of half the angle between the lines. So all of the new path is within the tolerance of the
// old one, in order, and no corner is cut by more than where the borders of the lines' bands meet.
//
// kBroken: there is no such matching. kNotProved: neither could be shown, as where a corner is cut
// within its bound but n is not found. Corners at which an arc takes part, and those sharper than
// kSharpestCut, are not cut: the strict reading holds there.
#pragma once

#include <cstddef>
#include <span>

#include "geometry/distance/path_distance.h"
#include "geometry/path/path.h"

namespace batten::geometry {

struct BandComparison {
  PathComparison paths;       // bounds are those of the matching without the corners
  double corner_at_most = 0;  // mm, greatest distance of a cut corner from its n
  std::size_t cut_corners = 0;
};

// As compare_paths, which decides alone where no corner of the old path is further than the
// tolerance from the new one. Where corners are cut, the parts between them are compared with the
// tolerance less kSamePlace, which covers the rounding of A, B and n.
[[nodiscard]] BandComparison compare_in_band(std::span<const PathPiece> old_path,
                                             std::span<const PathPiece> new_path, double tolerance);

// As match_paths (path_distance.h), in the band reading: at a corner that is cut, the new path
// waits for three pairs while the old one goes round it.
[[nodiscard]] PathMatching match_in_band(std::span<const PathPiece> old_path,
                                         std::span<const PathPiece> new_path, double tolerance);

}  // namespace batten::geometry
