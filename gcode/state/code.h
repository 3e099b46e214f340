// The number of a code.
#pragma once

namespace batten::gcode {

// A G or M code in tenths: G38.2 is 382, G1 is 10, M3 is 30.
using Code = int;

}  // namespace batten::gcode
