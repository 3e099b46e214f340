// What the control would say about the G06.2 blocks of a program.
#pragma once

#include "gcode/curves/nurbs.h"
#include "gcode/text/program.h"
#include "tests/support/curve_alarm.h"

namespace batten::gcode {

// Follows the whole program, from block to block, as far as G06.2 depends on it: the place, the
// modes that forbid a curve, the frame. Alarms in the order of the lines. Where a mode or place is
// set by something that is not understood, nothing is said about it. PS1010 is a matter of the
// operator (manual intervention), not of the text.
[[nodiscard]] CurveAlarms nurbs_alarms(const Program& program, const NurbsRules& rules);

}  // namespace batten::gcode
