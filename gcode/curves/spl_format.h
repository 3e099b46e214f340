// Heidenhain SPL as a CurveFormat: for the controls that read it as an option.
#pragma once

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

[[nodiscard]] const CurveFormat& heidenhain_spl();

}  // namespace batten::gcode
