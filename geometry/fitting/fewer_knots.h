// The same curve on fewer knots, within a given distance. Method: docs/algorithms/fewer_knots.md.
#pragma once

#include <optional>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

struct FewerKnotsOptions {
  double max_deviation = 0.005;  // mm, one curve to the other; > 0
  // Straight parts as long as this (mm) stay exactly straight, and the curve leaves them without
  // a kink or a step of curvature.
  double long_line = 5;
  // Parameters at which the curve stays at its place along itself too, to within max_deviation;
  // elsewhere it may run ahead or behind. Increasing.
  std::vector<double> places = {};
};

// A cubic on the same interval. Ends and corners are met exactly. The deviation is measured at
// samples, four to each span of `curve`: it is no proof.
//
// Returns nothing when fewer control points do not do. Requires degree 3. Linear cost.
[[nodiscard]] std::optional<BsplineCurve> on_fewer_knots(const BsplineCurve& curve,
                                                         const FewerKnotsOptions& options);

// About how many spans that takes, known before one is fitted: within a deviation (mm, > 0) a span
// of a cubic spline is as long as the third derivative may change along it (5/384 h^3 |change|, the
// error of interpolation on even knots). Mostly half to all of what is found then. Linear cost.
[[nodiscard]] double spans_expected(const CurvePieces& pieces, double deviation);

}  // namespace batten::geometry
