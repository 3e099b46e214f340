// G06.2 blocks of B-splines: FANUC and the controls that read its curves. Facts and sources:
// docs/controllers/fanuc_curves.md.
#pragma once

#include <functional>

#include "gcode/curves/curve_format.h"
#include "gcode/curves/curve_print.h"

namespace batten::gcode {

struct NurbsRules {
  KnotDigits knots;         // of K; the decimals hold for R too
  bool three_axes = false;  // X, Y and Z are all named, always
  // R1 in every block that has a place, rather than leaving the weight to be 1.
  bool weights = false;
  // G05 P10000 stands right before the curve, and G05 P0 right after it.
  bool framed = false;
};

// FANUC 15i/16i/18i/30i/31i, least increment 0.001 mm or 0.0001 inch.
[[nodiscard]] NurbsRules fanuc_nurbs(Units units);

// As FANUC, in the frame of G05 P10000 and G05 P0 that its sample has, with weights.
[[nodiscard]] NurbsRules syntec_nurbs(Units units);

// Mitsubishi M700V: four decimals, three axes, in the frame of G05 P10000 and G05 P0.
[[nodiscard]] NurbsRules mitsubishi_nurbs(Units units);

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
[[nodiscard]] CurveFormat nurbs_format(const std::function<NurbsRules(Units)>& rules);

// All only under --output curves: whether a control has the option is known to its owner alone.
[[nodiscard]] const CurveFormat& fanuc_curves();
[[nodiscard]] const CurveFormat& syntec_curves();
[[nodiscard]] const CurveFormat& mitsubishi_curves();

}  // namespace batten::gcode
