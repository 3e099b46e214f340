// G06.2 blocks of a cubic B-spline. Facts and sources: docs/controllers/fanuc_curves.md.
#pragma once

#include "gcode/curves/curve_text.h"
#include "gcode/curves/nurbs_rules.h"
#include "geometry/path/bspline_curve.h"

namespace batten::gcode {

// One block for each control point, then four with the last knot alone; with G05 P10000 before and
// G05 P0 after where the rules say so. P4 and K always, R1 or no R by the rules.
//
// The knots are scaled, then rounded to the fewest digits with which the curve moves by less than
// one step of its printed places, and to as many as the control takes where that is not
// reached: then the text says another curve, and the proof has to judge it.
// `setting.other` says how knots are printed; its decimals never exceed those of the rules.
//
// Refuses a curve that is not cubic and clamped, a start that cannot be printed, an axis that moves
// and is not named, numbers beyond the control's digits, distinct knots that would meet.
[[nodiscard]] CurveWriting write_nurbs(const geometry::BsplineCurve& curve,
                                       const CurveSetting& setting, const NurbsRules& rules);

}  // namespace batten::gcode
