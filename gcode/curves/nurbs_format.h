// G06.2 as the curves of a control; see gcode/curves/nurbs_write.h and nurbs_read.h.
#pragma once

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// All only under --output curves: whether a control has the option is known to its owner alone.
[[nodiscard]] const CurveFormat& fanuc_curves();
[[nodiscard]] const CurveFormat& syntec_curves();
[[nodiscard]] const CurveFormat& mitsubishi_curves();

}  // namespace batten::gcode
