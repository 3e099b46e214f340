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

struct ArcFitOptions {
  double max_deviation = 0.005;     // mm, both ways, curve to arcs and arcs to curve; > 0
  Vector3 axis = Vector3::UnitZ();  // the arcs' axis: normal of the plane that the target runs
  bool helical = false;             // may arcs rise along the axis (linearly in the angle)
  double min_radius = 0.1;          // mm; tighter places become short lines
  double max_radius = 1e4;          // mm; flatter ones become lines
  double max_sweep = 3.0;           // radians; below pi, so that no arc is ambiguous when rounded
  // Places are rounded to multiples of this (mm) before the arcs are computed, so that the
  // printed ends are the ends that the arcs were made for. 0: no rounding. The first and the
  // last place are met exactly and are not rounded.
  double grid = 0;
  ArcEffort effort = ArcEffort::kQuick;  // of a flat curve
  // Chains off the plane that take more pieces are not looked for.
  std::size_t at_most = std::numeric_limits<std::size_t>::max();
};

// Lines and arcs along `curve` between two parameters. The pieces chain exactly; where the
// curve is smooth, neighbouring pieces share their tangent to within the rounding that
// `grid` forces (see docs/algorithms/arc_fit.md), or where a place tighter than min_radius
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
