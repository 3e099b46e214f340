// How far the vertices of a path scatter about a smooth curve.
// Method: docs/algorithms/fair.md, section Noise.
#pragma once

#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// One value per vertex: the estimated standard deviation (mm) of its distance from the smooth
// path, local over some 80 vertices; 0 where the neighbourhood shows none. Corners that stand
// alone do not count as noise, nor does the curvature of a coarsely sampled curve: noise is
// what changes its sign from vertex to vertex.
//
// `parameters`: length along the path at each vertex, strictly increasing, same size.
[[nodiscard]] std::vector<double> vertex_noise(std::span<const Point3> points,
                                               std::span<const double> parameters);

}  // namespace batten::geometry
