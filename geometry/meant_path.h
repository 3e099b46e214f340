// Where noisy vertices were meant to be, as far as their neighbours tell: an estimate that no
// band holds. Method: docs/algorithms/fair.md, section Noise that fills the band.
#pragma once

#include <span>
#include <vector>

#include "geometry/path_features.h"
#include "geometry/point.h"

namespace batten::geometry {

// One place per vertex. Between kept corners, corners that no noise explains, and lines, it is on
// the cubic spline with a knot at every vertex that has the least sum of squared distances and of
// energy (the integral of |C'''|^2), the two weighed as generalised cross-validation says. The
// vertices that part those stretches stay, and so do stretches of less than eight. Linear time.
//
// `features`: of these points, neighbours apart.
[[nodiscard]] std::vector<Point3> meant_places(std::span<const Point3> points,
                                               const PathFeatures& features);

// The same, but only where an eighth of the vertices around is further from those places than
// `limit` (mm); elsewhere a vertex keeps its place. Empty where that is so nowhere.
[[nodiscard]] std::vector<Point3> meant_beyond(std::span<const Point3> points,
                                               const PathFeatures& features, double limit);

}  // namespace batten::geometry
