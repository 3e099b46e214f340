// G5 as the curves of a control; see gcode/curves/g5_curve.h.
#pragma once

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// LinuxCNC 2.9: only under --output curves. Pieces that bend one way, in G17, not under G41, G42.
[[nodiscard]] const CurveFormat& linuxcnc_g5();

// grblHAL and Marlin: only under --output curves, since arcs are run with far finer chords. Pieces
// in G17, none of them straight.
[[nodiscard]] const CurveFormat& chopped_g5();

}  // namespace batten::gcode
