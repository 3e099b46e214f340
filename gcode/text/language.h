// In which language a program is written: how its text is cut into blocks and words.
#pragma once

#include <cstdint>
#include <string_view>

namespace batten::gcode {

enum class Language : std::uint8_t {
  kRs274,     // G01 X1. Y2. and what FANUC, Haas, LinuxCNC, grbl .. made of it
  kSiemens,   // Sinumerik: X=10, R1=5, MSG("..", CYCLE832(..), labels, ; comments
  kKlartext,  // Heidenhain: L X+1 Y+2 F500
};

// For people: "Siemens Sinumerik".
[[nodiscard]] std::string_view describe(Language language);

}  // namespace batten::gcode
