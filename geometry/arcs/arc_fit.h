// Arcs for a curve: tangent-continuous chains of lines, circular arcs and helical arcs.
// Method: docs/algorithms/arc_fit.md.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "geometry/arcs/arc_spline.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/path.h"

namespace batten::geometry {

struct ArcFitOptions : ArcRange {
  double max_deviation = 0.005;          // mm, both ways, curve to arcs and arcs to curve; > 0
  Vector3 axis = Vector3::UnitZ();       // the arcs' axis: normal of the plane that the target runs
  bool helical = false;                  // may arcs rise along the axis (linearly in the angle)
  ArcEffort effort = ArcEffort::kQuick;  // of a flat curve
  // Chains that take more pieces are not looked for.
  std::size_t at_most = std::numeric_limits<std::size_t>::max();
};

struct ArcFitTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // mm: the last decimal that any program carries [at 0: PlanArcs.TakesThePlaneThatTheRunLiesIn]
  double one_height = 1e-6;
  // Of the deviation of a helix. The two parts are at right angles: 0.8^2 + 0.6^2 = 1.
  double plane_share = 0.8;
  double height_share = 0.6;
  double beyond_run = 1.5;  // arcs that hold a straight run and half as much again go over it [<]
  double least_run_in_grids = 50;  // a shorter run would have its direction from rounding [at 0]
  // In the plane the curve is held against chords that leave it by no more than this part of
  // the deviation: below what the band takes for one edge without samples between.
  double chord_part = 0.018;
  int chords_read = 3;  // of a piece [< FitArcs.ChordsAlongAnSAreThoseOfBothItsBends]
};
inline constexpr ArcFitTuning kArcFitTuning;

// Lines and arcs along `curve` between two parameters. The pieces chain exactly; where the
// curve is smooth, neighbouring pieces share their tangent to within the rounding that
// `grid` forces (see docs/algorithms/arc_fit.md), or where a bend tighter than min_radius
// has to be crossed by short lines. Returns nothing when the curve leaves the planes across
// `axis` and `helical` is false, when its rise cannot be held by helices and lines, or when
// that takes more pieces than chords would be.
//
// Requires degree 3 or less, first() <= from < to <= last(), an axis of unit length. Throws
// std::invalid_argument when max_deviation is not positive or max_sweep not in ]0, pi[.
//
// Each straight span of the curve that is longer than an arc could be held on stays a Line.
[[nodiscard]] std::optional<Path> fit_arcs(const BsplineCurve& curve, double from, double to,
                                           const ArcFitOptions& options);

// The same for all of a curve that is in its pieces already. `chords`: chords_along of them.
[[nodiscard]] std::optional<Path> fit_arcs(const MarkedPieces& pieces, double chords,
                                           const ArcFitOptions& options);

// About how many chords within `deviation` (mm) the curve takes.
[[nodiscard]] double chords_along(const CurvePieces& pieces, double deviation);

}  // namespace batten::geometry
