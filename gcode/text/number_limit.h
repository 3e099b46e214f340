// How great a number a program may hold.
#pragma once

namespace batten::gcode {

// No control takes numbers as great as this, and none that we write is.
inline constexpr double kNumberLimit = 1e9;

}  // namespace batten::gcode
