// Where noisy vertices were meant to be, as far as their neighbours tell: an estimate that no
// band holds. Method: docs/algorithms/fair.md, section Noise that takes much of the band.
#pragma once

#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/fair/path_features.h"

namespace batten::geometry {

// One place per vertex. Between kept corners, corners that no noise explains, and lines, it is on
// the cubic spline with a knot at every vertex that has the least sum of squared distances and of
// energy (the integral of |C'''|^2), the two weighed as generalised cross-validation says. The
// vertices that part those stretches stay, and so do stretches of less than eight. Linear time.
//
// `features`: of these points, neighbours apart.
[[nodiscard]] std::vector<Point3> denoised_positions(std::span<const Point3> points,
                                                     const PathFeatures& features);

// The same, but only where noise takes a good part of the `limit` (mm): where vertices scatter by a
// fifth of it and by more than two of the greatest errors of `rounding` (mm), or an eighth of those
// around is further from their places than it. Elsewhere, and in stretches that a straight line
// between their ends follows within the limit, a vertex keeps its place. Empty where that is so
// nowhere.
[[nodiscard]] std::vector<Point3> meant_among_noise(std::span<const Point3> points,
                                                    const PathFeatures& features, double limit,
                                                    double rounding);

}  // namespace batten::geometry
