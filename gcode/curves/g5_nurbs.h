// G5.2 .. G5.3 of LinuxCNC: the control points of a B-spline. Read, never written: its knots are
// always even. Facts: docs/controllers/linuxcnc.md.
#pragma once

#include <cstdint>

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// Block `first` has G5.2, perhaps with X and Y, P, L (the order, 3 where it is left out) and F. The
// place of the tool is the first control point; each further one is X, Y and P in a block of its
// own, up to G5.3 alone. Refused are weights (P) that are not positive, orders other than 2 to 6,
// fewer points than the order, and all other words.
[[nodiscard]] CurveResult read_g5_nurbs(const Program& program, std::uint32_t first,
                                        const CurveStart& start);

}  // namespace batten::gcode
