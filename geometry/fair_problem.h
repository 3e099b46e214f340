// States the fairing of a path as a fit: where knots may start, which places the curve has to
// keep and how closely. Method: docs/algorithms/fair.md, sections Band and Corners.
#pragma once

#include <span>
#include <vector>

#include "geometry/bspline_fit.h"
#include "geometry/path_features.h"
#include "geometry/point.h"

namespace batten::geometry {

struct BandOptions {
  double limit = 0.01;  // mm, full distance allowed
  // mm: a curve that passes the printed places at their rounding is as likely as one that meets
  // them; the errors of dense places on a slanting line are no white noise, but long ramps.
  double least_scatter = 5e-4;
};

// `loosen[i]` >= 1 widens the scatter expected at vertex i (the machine needs more room
// there); infinite: only the limit counts. Empty: 1 everywhere.
[[nodiscard]] FitProblem state_fair_problem(std::span<const Point3> points,
                                            const PathFeatures& features,
                                            std::span<const double> loosen,
                                            const BandOptions& options);

}  // namespace batten::geometry
