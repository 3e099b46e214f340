// How far a stretch of a curve is from a straight line or chord: the greatest distance itself, not
// a distance at samples.
#pragma once

#include "geometry/basic/point.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

// Greatest distance (mm) of the curve between two parameters, from < to, from the chord between its
// places there. Right to 1e-12 of itself and to rounding: pieces are halved until their control
// points, which bound them, and their ends agree.
[[nodiscard]] double chord_deviation(const CurvePieces& pieces, double from, double to);

// The first parameter after `from` where the curve is `distance` (mm, > 0) away from its tangent at
// `from`, or `to` where it never is before; right to rounding of the parameter.
[[nodiscard]] double leaves_tangent_at(const CurvePieces& pieces, double from, double to,
                                       double distance);

}  // namespace batten::geometry
