// G06.2 blocks of B-splines: FANUC and the controls that read its curves. Facts and sources:
// docs/controllers/fanuc_curves.md.
#pragma once

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// What is written: one block for each control point of a clamped cubic, then four with the last
// knot alone; with G05 P10000 before and G05 P0 after where the rules say so. P4 and K always, R1
// or no R by the rules. The knots are scaled, then rounded to the fewest digits with which the
// curve moves by less than one step of its printed places, and to as many as the control takes
// where that is not reached: then the text says another curve, and the proof has to judge it.
// `setting.other` says how knots are printed; its decimals never exceed those of the rules.
//
// What is read is only what a control would run: G06.2 with K and the first point in block `first`
// (or in the one after G05 P10000), points, as many blocks of K alone as the order says (2 to 4),
// nothing between them but N words. Everything that would be an alarm of the control is refused,
// and weights that differ.
//
// All only under --output curves: whether a control has the option is known to its owner alone.
[[nodiscard]] const CurveFormat& fanuc_curves();
[[nodiscard]] const CurveFormat& syntec_curves();
[[nodiscard]] const CurveFormat& mitsubishi_curves();

}  // namespace batten::gcode
