// What a Siemens control would say about the POLY blocks of a program.
#pragma once

#include "gcode/text/program.h"
#include "tests/support/curve_alarm.h"

namespace batten::gcode {

// What the control would say, or silently do, about the polynomials of a program:
//   poly-not-active   PO words where POLY is not active: run as straight lines, no alarm
//   poly-length       PL outside its range
//   poly-denominator  0 inside the interval
//   poly-degree       above three: not every version of the control reads it
//   poly-compensation under G41 or G42, where Batten never writes one
//   line-too-long     above 512 characters
[[nodiscard]] CurveAlarms poly_alarms(const Program& program);

}  // namespace batten::gcode
