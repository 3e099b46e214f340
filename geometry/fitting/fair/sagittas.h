// How far a smooth curve through the vertices of a polyline would leave its edges.
// Method: docs/algorithms/fair.md, section Noise.
#pragma once

#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

// Per edge, mm: the height of the cubic that meets both of its ends at half of their turns.
// `parameters`: length along the path at each vertex; `turns` (radians) and `noise` (mm) of each
// vertex. Where the path turns to different sides at the two ends, by more than its noise, the
// cubic crosses the edge: the greater of its two bows counts.
[[nodiscard]] std::vector<double> sagittas(std::span<const Point3> points,
                                           std::span<const double> parameters,
                                           std::span<const double> turns,
                                           std::span<const double> noise);

}  // namespace batten::geometry
