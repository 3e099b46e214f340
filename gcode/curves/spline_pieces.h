// Splines of any degree up to kMaxDegree, with weights, as the cubic pieces that a reading has.
#pragma once

#include <cstdint>
#include <span>

#include "gcode/curves/curve_format.h"
#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/rational_bezier.h"

namespace batten::gcode {

// Adds what a block says as cubic pieces from `start` to `end`, which are the ends of `piece` but
// for rounding. False, and nothing is added, where `piece` takes too many.
[[nodiscard]] bool add_cubics(std::uint32_t block, const geometry::RationalBezier& piece,
                              const geometry::Point3& start, const geometry::Point3& end,
                              CurveReading& reading);

// A B-spline with weights, whose first point is where the tool stands and whose spans that are not
// empty belong to `blocks`, one each. Exact where all weights are the same and the degree is three
// or less. False where it takes too many pieces.
[[nodiscard]] bool add_spline(const geometry::BsplineBasis& basis,
                              std::span<const geometry::Point3> points,
                              std::span<const double> weights,
                              std::span<const std::uint32_t> blocks, CurveReading& reading);

}  // namespace batten::gcode
