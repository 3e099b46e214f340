// How a control says how long it waits.
#pragma once

#include <cstdint>

namespace batten::gcode {

enum class DwellForm : std::uint8_t {
  kUnknown,         // not known, or a parameter of the machine says it; X1.5 alone is seconds
  kSecondsP,        // G4 P1.5: LinuxCNC, grbl
  kSecondsX,        // G4 X1.5: Beckhoff
  kSecondsXOrMsP,   // G4 X1.5 with its point, or P1500 without one: FANUC
  kSecondsByPoint,  // G4 P1.5 in seconds, P1500 in milliseconds: Haas
  kSecondsF,        // G4 F1.5: Siemens
};

}  // namespace batten::gcode
