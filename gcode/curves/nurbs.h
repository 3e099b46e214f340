#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "gcode/curves/curve_print.h"
#include "gcode/state/modal_state.h"
#include "geometry/path/bspline_curve.h"

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

// G06.2 blocks as the curve that their printed numbers say.

// What the blocks of one G06.2 say, of order 2 to 4, with weights.
struct NurbsText {
  int order = 4;
  std::vector<double> knots;
  std::vector<geometry::Point3> points;  // mm; axes that are not named stay where they were
  std::vector<double> weights;
  std::vector<std::uint32_t> point_blocks;  // index into Program::blocks, one per point
  std::uint32_t blocks = 0;                 // from the first on, with the frame
  std::array<bool, 3> axes = {false, false, false};
  std::optional<double> feed;  // as printed

  // At a parameter of the printed knots; rational where weights differ.
  [[nodiscard]] geometry::Point3 point_at(double u) const;

  [[nodiscard]] bool is_polynomial() const;            // all weights are the same
  [[nodiscard]] geometry::BsplineCurve curve() const;  // requires is_polynomial()
};

// Reads only what a control would run: G06.2 with K and the first point in block `first` (or in the
// one after G05 P10000, where the rules frame a curve), points, as many blocks of K alone as the
// order says, nothing between them but N words. Refuses everything else, and everything that would
// be an alarm of the control.
[[nodiscard]] std::variant<NurbsText, CurveRefusal> read_nurbs_text(const Program& program,
                                                                    std::uint32_t first,
                                                                    const CurveStart& start,
                                                                    const NurbsRules& rules);

// The same as pieces; refuses weights that differ. Piece i belongs to the block of control point
// i + order - 1.
[[nodiscard]] CurveResult read_nurbs(const Program& program, std::uint32_t first,
                                     const CurveStart& start, const NurbsRules& rules);

// G06.2 blocks of a cubic B-spline. Facts and sources: docs/controllers/fanuc_curves.md.

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

// G06.2 as the curves of a control; see gcode/curves/nurbs.h and nurbs_read.h.

// All only under --output curves: whether a control has the option is known to its owner alone.
[[nodiscard]] const CurveFormat& fanuc_curves();
[[nodiscard]] const CurveFormat& syntec_curves();
[[nodiscard]] const CurveFormat& mitsubishi_curves();

}  // namespace batten::gcode
