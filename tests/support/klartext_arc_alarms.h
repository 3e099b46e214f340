// What a Heidenhain control would say about the arcs of a program: CC and C. Facts:
// docs/controllers/heidenhain_curves.md.
#pragma once

#include "gcode/state/modal_state.h"
#include "gcode/text/program.h"
#include "tests/support/curve_alarm.h"

namespace batten::gcode {

// What the control would say about the arcs of a program whose lengths are in these units:
//   arc-radius     the ends are not on one circle about CC
//   arc-no-centre  a C without a CC before it
//   arc-no-sense   a C without DR
//   place-range    beyond +-99999.9999
[[nodiscard]] CurveAlarms klartext_arc_alarms(const Program& program, Units units);

}  // namespace batten::gcode
