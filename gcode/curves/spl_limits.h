// What the numbers of an SPL block may be (iTNC 530 manual, 60642x-04, p. 541).
#pragma once

namespace batten::gcode {

inline constexpr double kGreatestMantissa = 9.99999999;  // of a coefficient
inline constexpr int kMantissaDecimals = 8;
inline constexpr double kGreatestEnd = 99999.9999;  // of an end point, mm

}  // namespace batten::gcode
