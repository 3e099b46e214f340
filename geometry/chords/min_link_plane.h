// Minimum-link polylines in the tolerance strip of a plane curve: the greedy sweep of windows,
// exact up to the gates that stand for the curve. Method: docs/algorithms/min_link.md.
//
// L. J. Guibas, J. E. Hershberger, J. S. B. Mitchell, J. S. Snoeyink, Approximating polygons and
// subdivisions with minimum-link paths, Int. J. Computational Geometry & Applications 3 (1993)
// 383-415: ordered stabbing, of which this is the case where the objects are gates that do
// not cross; S. Suri, A linear time algorithm for minimum link paths inside a simple polygon,
// Computer Vision, Graphics and Image Processing 35 (1986) 99-110: windows.
#pragma once

#include <optional>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/chords/linearize.h"
#include "geometry/chords/min_link_gates.h"

namespace batten::geometry {

// The fewest links from `start`, on the first gate, to the centre of the last one, through all
// gates in order, at most `width` (mm) from their centres. Vertices are on gates, or where a
// link cannot go further. Each link turns as late as possible.
//
// The curve lies in a plane across `normal` (unit length), or so near to it that what is across
// does not matter: points are the gates' centres moved in the plane. Nothing when the curve bends
// so closely that no link gets through two gates.
[[nodiscard]] std::optional<std::vector<LinkVertex>> min_link_in_plane(const GateChain& gates,
                                                                       const Vector3& normal,
                                                                       const Point3& start,
                                                                       double width);

}  // namespace batten::geometry
