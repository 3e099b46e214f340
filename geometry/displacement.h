// How far a curve was moved, when another curve with the same knots was made of it: bounds on
// |C(u) - C0(u)| that hold for every u, not only at samples. (It is never less than the distance
// of the two curves at u, so it bounds that distance as well.)
#pragma once

#include <vector>

#include "geometry/bspline_curve.h"

namespace batten::geometry {

// The curve u -> moved(u) - original(u). Requires equal knots (throws std::invalid_argument
// where the numbers of control points differ; the knots themselves are not compared).
[[nodiscard]] BsplineCurve displacement_between(const BsplineCurve& original,
                                                const BsplineCurve& moved);

// For each span of displacement.breakpoints() a number (mm) that |displacement| does not exceed
// there, and exceeds the greatest |displacement| of the span by no more than `slack` (mm, > 0).
// Bezier pieces are halved until their control points say so. Requires degree 3 or less.
[[nodiscard]] std::vector<double> displacement_bounds(const BsplineCurve& displacement,
                                                      double slack);

}  // namespace batten::geometry
