// What a Heidenhain control would say about the SPL blocks of a program.
#pragma once

#include "gcode/state/modal_state.h"
#include "gcode/text/program.h"
#include "tests/support/curve_alarm.h"

namespace batten::gcode {

// What the control would say about the splines of a program whose lengths are in these units:
//   spl-closure       the start is 1 um or more from the tool's position
//   spl-first         no L before the first SPL
//   spl-order         K3, K2, K1 of an end axis are missing, repeated, or in another order
//   spl-axes          fewer than two axes, or more than five
//   spl-coefficient   a mantissa above 9.99999999, or with more than 8 decimals
//   spl-exponent      beyond -255 .. 255
//   spl-end           beyond +-99999.9999
//   spl-words         the block is not understood
//   spl-kink          a warning: 0.1 degrees or more between two splines
[[nodiscard]] CurveAlarms spl_alarms(const Program& program, Units units);

}  // namespace batten::gcode
