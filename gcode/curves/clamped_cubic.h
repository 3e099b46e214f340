// What the curve blocks of most controls can hold.
#pragma once

#include "geometry/path/bspline_curve.h"

namespace batten::gcode {

// A cubic that starts and ends in its outer control points.
[[nodiscard]] inline bool is_clamped_cubic(const geometry::BsplineCurve& curve) {
  constexpr std::size_t kOrder = 4;
  const auto& t = curve.basis().knots();
  return curve.degree() == 3 && t[0] == t[kOrder - 1] && t[t.size() - kOrder] == t.back();
}

}  // namespace batten::gcode
