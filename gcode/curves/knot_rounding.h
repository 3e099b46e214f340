// Knots with few digits. A knot vector may be moved and stretched without changing its curve, so
// knots are scaled to a range that its printed digits resolve before they are rounded.
#pragma once

#include <optional>
#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::gcode {

struct KnotDigits {
  int digits = 9;    // all together
  int decimals = 3;  // of them behind the point
};

struct PrintedKnots {
  std::vector<double> knots;  // from 0, each a number with `decimals` decimals
  int decimals = 0;
  double move = 0;  // mm: how far the curve is from the one with exact knots, by greatest_move
};

// The fewest steps for the whole range, of 100, 1000, .. that keep the curve within `enough` (mm)
// of the one with exact knots; the most steps that the digits allow where none do. Distinct knots
// stay distinct and equal ones equal; nothing where the digits do not allow that. Whole numbers as
// long as the digits before the point suffice. Requires degree 3 or less and a clamped curve.
[[nodiscard]] std::optional<PrintedKnots> print_knots(const geometry::BsplineCurve& curve,
                                                      const KnotDigits& digits, double enough);

}  // namespace batten::gcode
