// How far a curve was moved, when another curve with the same knots was made of it. The
// displacement D(u) = C(u) - C0(u) is a spline itself, its control points the moves of the control
// points. Bounds on |D(u)| that hold for every u, not only at samples; no place of either curve is
// further from the other curve than the greatest |D|.
#pragma once

#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// For each span of displacement.breakpoints() a number (mm) that |displacement| does not exceed
// there, and exceeds the greatest |displacement| of the span by no more than `slack` (mm, > 0).
// Bezier pieces are halved until their control points say so. Requires degree 3 or less.
[[nodiscard]] std::vector<double> displacement_bounds(const BsplineCurve& displacement,
                                                      double slack);

}  // namespace batten::geometry
