// G06.2 blocks as the curve that their printed numbers say.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "gcode/curves/curve_text.h"
#include "gcode/curves/nurbs_rules.h"
#include "geometry/path/bspline_curve.h"

namespace batten::gcode {

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

}  // namespace batten::gcode
