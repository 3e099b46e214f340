// Angles in radians.
#pragma once

#include <cmath>
#include <numbers>

namespace batten::geometry {

inline constexpr double kPi = std::numbers::pi;

// The same direction within half a turn of zero, either way.
[[nodiscard]] inline double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

}  // namespace batten::geometry
