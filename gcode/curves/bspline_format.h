// BSPLINE as the curves of Siemens controls; see gcode/curves/siemens_bspline.h.
#pragma once

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// Only under --output curves, and for who names the target that has them: what the control makes of
// the blocks is not verified, and caution() says so.
[[nodiscard]] const CurveFormat& siemens_bspline();

}  // namespace batten::gcode
