// Units in which people give numbers, in those in which we reckon.
#pragma once

#include <numbers>

namespace batten::postproc {

inline constexpr double kInch = 25.4;                      // mm
inline constexpr double kMinute = 60;                      // s
inline constexpr double kRadian = 180 / std::numbers::pi;  // degrees

}  // namespace batten::postproc
