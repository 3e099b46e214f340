// POLY as the curves of Siemens controls; see gcode/curves/siemens_poly.h.
#pragma once

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

[[nodiscard]] const CurveFormat& siemens_poly();

}  // namespace batten::gcode
