// What the controls that read G06.2 have in common, and where they differ. Facts and sources:
// docs/controllers/fanuc_curves.md.
#pragma once

#include <string_view>

#include "gcode/curves/knot_rounding.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {

struct NurbsRules {
  std::string_view control;  // for messages: "FANUC"
  KnotDigits knots;          // of K; the decimals hold for R too
  bool three_axes = false;   // X, Y and Z are all named, always
  // R1 in every block that has a place, rather than leaving the weight to be 1.
  bool weights = false;
  // G05 P10000 stands right before the curve, and G05 P0 right after it.
  bool framed = false;

  // What the control calls what is wrong with a block.
  std::string_view missing_knot = "PS1002";
  std::string_view wrong_mode = "PS1006";   // G06.2 under G41, G93 ..
  std::string_view wrong_start = "PS1009";  // the first point is not where the tool stands
  std::string_view decreasing = "knot-decreases";
  std::string_view axis_too_late = "axis-not-in-first-block";
  std::string_view too_many_decimals = "too-many-decimals";
};

// FANUC 15i/16i/18i/30i/31i, least increment 0.001 mm or 0.0001 inch.
[[nodiscard]] NurbsRules fanuc_nurbs(Units units);

// As FANUC, in the frame of G05 P10000 and G05 P0 that its sample has, with weights.
[[nodiscard]] NurbsRules syntec_nurbs(Units units);

// Mitsubishi M700V: four decimals, three axes, in the frame of G05 P10000 and G05 P0.
[[nodiscard]] NurbsRules mitsubishi_nurbs();

inline constexpr std::string_view kFrameBegin = "G05 P10000";
inline constexpr std::string_view kFrameEnd = "G05 P0";

// Why the control would refuse a G06.2 in this state, or draw another curve than the one that was
// meant; empty where it takes it. What is not known counts as what is not allowed.
[[nodiscard]] std::string_view nurbs_complaint(const ModalState& state);

}  // namespace batten::gcode
