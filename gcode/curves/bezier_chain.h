// Chains of cubic Bezier pieces, as curve words say them one by one.
#pragma once

#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// How far two chains are apart at most (mm), pieces taken in pairs at equal parameters: the
// greatest distance of two control points. It bounds the distance of the curves in order, both
// ways, and counts places that slid along the curve as well as those that left it. Throws
// std::invalid_argument unless both have the same number of pieces.
[[nodiscard]] double greatest_move(std::span<const geometry::CubicBezier> a,
                                   std::span<const geometry::CubicBezier> b);

// The piece between two places near its ends, with the same tangents: inner control points move
// with the end that they belong to. So rounding of ends makes no kinks.
[[nodiscard]] geometry::CubicBezier between(const geometry::CubicBezier& piece,
                                            const geometry::Point3& start,
                                            const geometry::Point3& end);

// a[0] + a[1] t + a[2] t^2 + a[3] t^3 for t from 0 to 1.
struct CubicCoefficients {
  geometry::Vector3 a[4];
};
[[nodiscard]] CubicCoefficients coefficients_of(const geometry::CubicBezier& piece);
[[nodiscard]] geometry::CubicBezier bezier_of(const CubicCoefficients& coefficients);

// The angle (radians) between the direction in which `before` arrives and the one in which
// `after` leaves; 0 where one of them has none.
[[nodiscard]] double kink_between(const geometry::CubicBezier& before,
                                  const geometry::CubicBezier& after);

}  // namespace batten::gcode
