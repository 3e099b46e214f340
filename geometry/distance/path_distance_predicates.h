// The part of path_distance that must not be wrong by a rounding step: are the pairs of a
// matching within the tolerance? In rounded numbers where these decide, by exact arithmetic
// (CGAL) where they do not.
#pragma once

#include "geometry/distance/chord_polyline.h"
#include "geometry/distance/free_space.h"

namespace batten::geometry {

// mm, a bound for the rounding of a distance of two places of these polylines, computed in
// doubles.
[[nodiscard]] double distance_noise(const ChordPolyline& a, const ChordPolyline& b);

// Is every pair of the matching within `tolerance` minus the chord errors beside it? Exactly:
// a distance that equals the tolerance is within, one that is longer by any amount is not.
//
// A coordinate is taken as the decimal of nine digits after the point (mm) that the double
// stands for, where there is one: coordinates come from printed millimetres, or from printed
// inches of up to eight decimals times 25.4, and both are such decimals. So is the tolerance.
// Other coordinates are taken as the number that the double is.
//
// A pair of a vertex and a place inside an edge may be read as the vertex and the foot of the
// perpendicular from it, where the foot lies in order: the foot is exact, the double is not.
//
// Requires: the matching goes forward (goes_forward).
[[nodiscard]] bool within_tolerance(const Matching& matching, const ChordPolyline& a,
                                    const ChordPolyline& b, double tolerance);

}  // namespace batten::geometry
