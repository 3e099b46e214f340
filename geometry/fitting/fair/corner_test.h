// Whether a vertex among noisy ones is a corner: its two sides are judged, not the vertex alone.
// Method: docs/algorithms/fair.md, section Corners among noise.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// No more vertices on either side are looked at, and no fewer on both together.
inline constexpr std::size_t kMostBesideKink = 6;
inline constexpr std::size_t kFewestAroundKink = 5;

struct Kink {
  double angle = 0;      // radians, at which the two sides meet
  double deviation = 0;  // radians: what noise makes of no kink at all, as a standard deviation
};

// The kink at `vertex` of the polynomial that fits `points` best (least squares) and may be broken
// there. Its degree is 4, or less where there are few points.
//
// `parameters`: length along the path, one per point, increasing. `noise`: mm, standard deviation
// of the points across the path. Returns nothing at an end, and where there are too few vertices.
[[nodiscard]] std::optional<Kink> kink_at(std::span<const Point3> points,
                                          std::span<const double> parameters, std::size_t vertex,
                                          double noise);

// How far the vertices of a path scatter about a smooth curve.
// Method: docs/algorithms/fair.md, section Noise.

// One value per vertex: the estimated standard deviation (mm) of its distance from the smooth
// path, local over some 80 vertices; 0 where the neighbourhood shows none. Corners that stand
// alone do not count as noise, nor does the curvature of a coarsely sampled curve: noise is
// what changes its sign from vertex to vertex.
//
// `parameters`: length along the path at each vertex, strictly increasing, same size.
[[nodiscard]] std::vector<double> vertex_noise(std::span<const Point3> points,
                                               std::span<const double> parameters);

}  // namespace batten::geometry
