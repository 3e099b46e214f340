// In which language a program is written: how its text is cut into blocks and words.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace batten::gcode {

enum class Language : std::uint8_t {
  kRs274,     // G01 X1. Y2. and what FANUC, Haas, LinuxCNC, grbl .. made of it
  kSiemens,   // Sinumerik: X=10, R1=5, MSG("..", CYCLE832(..), labels, ; comments
  kKlartext,  // Heidenhain: L X+1 Y+2 F500
};

// For people: "Siemens Sinumerik".
[[nodiscard]] constexpr std::string_view describe(Language language) {
  constexpr std::string_view kNames[] = {"the RS-274 family", "Siemens Sinumerik",
                                         "Heidenhain Klartext"};
  return kNames[static_cast<std::size_t>(language)];
}

// What a number without a decimal point means. Controls of the FANUC kind take X1000 for 1000 mm or
// for 1000 least increments (1.000 mm), as a parameter of theirs says: no program tells which. All
// others take it for 1000 mm.
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

// How a control says how long it waits.
enum class DwellForm : std::uint8_t {
  kUnknown,         // not known, or a parameter of the machine says it; X1.5 alone is seconds
  kSecondsP,        // G4 P1.5: LinuxCNC, grbl
  kSecondsX,        // G4 X1.5: Beckhoff
  kSecondsXOrMsP,   // G4 X1.5 with its point, or P1500 without one: FANUC
  kSecondsByPoint,  // G4 P1.5 in seconds, P1500 in milliseconds: Haas
  kSecondsF,        // G4 F1.5: Siemens
};

}  // namespace batten::gcode
