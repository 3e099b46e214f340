// Curves, lines and Bezier pieces as one B-spline curve. Linear cost.
#pragma once

#include <span>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// Clamped cubics, one or more, each starting at the parameter and the position where the one
// before it ends (positions that differ by rounding: the earlier part's). The joints are triple
// knots: the curve is the parts, to the last digit, and may have corners there.
//
// Throws std::invalid_argument when there is no part, or one is no clamped cubic, or the
// parameters do not join.
[[nodiscard]] BsplineCurve joined(std::span<const BsplineCurve> parts);

// Lines and cubic Bezier pieces, one or more. Piece i runs over [stations[i], stations[i + 1]];
// stations increase strictly and are one more than pieces.
//
// Throws std::invalid_argument when they are not, or when a piece is an arc.
[[nodiscard]] BsplineCurve curve_of_pieces(std::span<const PathPiece> pieces,
                                           std::span<const double> stations);

// The Bezier pieces of a curve of degree 3 or less.
[[nodiscard]] Path beziers_of(const BsplineCurve& curve);

// mm, along a curve of degree 3 or less.
[[nodiscard]] double length_of(const BsplineCurve& curve);

// The straight chain through `points`, as pieces. Neighbours that are one place are joined.
[[nodiscard]] Path path_through(std::span<const Point3> points);

}  // namespace batten::geometry
