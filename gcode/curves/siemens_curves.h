// The curves of Siemens controls, POLY and BSPLINE. Facts and sources:
// docs/controllers/siemens_curves.md.
#pragma once

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// POLY: one polynomial per axis and block. One block per piece is written, POLY in the first, PL
// left out (1). The end is printed as `setting.places` says, the two coefficients with
// `setting.other`; the linear one is not printed: the control computes it from the ends, so each
// block starts exactly where the one before ended. The printed piece has the tangents of the given
// one at both ends: rounded ends make no kinks.
//
// What is read: block `first` has POLY; what follows belongs to it as long as it consists of PO, PL
// and axis words: those without PO are straight, as the control runs them. G90 may stand beside
// POLY. Refused are rational polynomials and those above the third degree, coefficients for an axis
// whose position is not known, and PL outside 0.0001 to 99999.9999.
[[nodiscard]] const CurveFormat& siemens_poly();

// BSPLINE: the control points of a B-spline. Only under --output curves, and for who names the
// target that has them: what the control makes of the blocks is not verified, and the caution says
// so. What is read has the same assumptions as what is written.
[[nodiscard]] const CurveFormat& siemens_bspline();

}  // namespace batten::gcode
