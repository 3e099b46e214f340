// More knots for a cubic B-spline, all at once.
#pragma once

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// The same curve with a knot in the middle of every span, `times` times. Requires degree 3.
// Linear cost.
[[nodiscard]] BsplineCurve with_spans_halved(const BsplineCurve& curve, int times);

}  // namespace batten::geometry
