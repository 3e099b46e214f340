// What a number without a decimal point means. Controls of the FANUC kind take X1000 for 1000 mm or
// for 1000 least increments (1.000 mm), as a parameter of theirs says: no program tells which. All
// others take it for 1000 mm.
#pragma once

#include <cstdint>

namespace batten::gcode {

enum class PointlessNumbers : std::uint8_t {
  kUnits,       // X5 is X5.
  kIncrements,  // X5 is five least increments
  kUndeclared,  // either: a length without a point has no known value
};

struct Decimals {
  PointlessNumbers pointless = PointlessNumbers::kUnits;
  // Decimals of the least increment in millimetre programs: 3 is 0.001 mm (IS-B). That of inch
  // programs has one more.
  int increment_decimals = 3;
  bool operator==(const Decimals&) const = default;
};

// The least increments that controls have: 1 mm to 0.00001 mm.
inline constexpr int kMostIncrementDecimals = 5;

}  // namespace batten::gcode
