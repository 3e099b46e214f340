// Chords that lie on both sides of their curve instead of on its inside.
// Method: docs/algorithms/linearize.md, section Balanced chords.
#pragma once

#include <span>
#include <vector>

#include "geometry/chords/min_link.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// Vertices beside the curve at these parameters (increasing): each is moved to the outside of its
// bend by two thirds of the height of the chords that meet there. So the area between chords and
// curve vanishes, their mean square distance is the least, and the greatest is two thirds of what
// it was. The first and the last vertex and corners of the curve (triple knots) stay on it.
[[nodiscard]] std::vector<LinkVertex> balanced_chords(const BsplineCurve& curve,
                                                      std::span<const double> parameters);

// The rms distance of such chords over the height of the chords between the same parameters:
// sqrt(4/45), that of a parabola from its mean; sqrt(8/15) for chords whose ends are on the curve.
inline constexpr double kBalancedError = 0.298;
inline constexpr double kChordError = 0.730;

}  // namespace batten::geometry
