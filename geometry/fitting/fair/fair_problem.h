// What is asked of the fairing of a path (fair.h), and how that is stated as a fit: where knots may
// start, which places the curve has to keep and how closely. Method: docs/algorithms/fair.md,
// sections Band and Corners.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/fair/path_features.h"
#include "geometry/fitting/fit_problem.h"

namespace batten::geometry {

struct FairOptions {
  double tolerance = 0.01;         // mm, curve to polyline and back, in order; > 0
  double rounding = 0.0005;        // mm, greatest error of one printed coordinate of the input
  double keep_corner_angle = 3.2;  // radians: vertices that turn more stay as they are (> pi: none)
  double feed = 1000;              // mm/min that the machine should hold (the greatest of the run)
  double acceleration = 1000;      // mm/s^2 across the path that the machine can give
  double jerk = std::numeric_limits<double>::infinity();  // mm/s^3, the same
  double scatter = 0;     // mm that vertices may scatter about the curve, beyond their noise:
                          // a simpler curve, further from the path that was meant
  bool accurate = false;  // spend the tolerance on noise only, never on feed
  // Pass vertices as near as their decimals tell their places, which takes more control points;
  // else as near as their rounding lets them scatter.
  bool near = true;
  // Per edge, from each point to the next: the part of the tolerance that the curve may use there,
  // above 0 and 1 at most. Empty: all of it everywhere. Has to outlive the call.
  std::span<const double> rooms;
};

struct BandOptions {
  double limit = 0.01;     // mm, full distance allowed
  double rounding = 5e-4;  // mm, greatest error of a printed coordinate
  double scatter = 0;      // mm, as FairOptions
  bool accurate = false;   // as FairOptions
  bool near = true;        // the same

  // The places that vertices were meant to have where noise takes much of the band, and their own
  // places elsewhere; empty: nowhere.
  std::span<const Point3> meant;
};

// How closely an edge is watched that an earlier curve has left.
struct EdgeRefinement {
  double share = 1;    // of the limit that is given out beside it
  int violations = 0;  // so often the curve left it: it gets more samples
};

// Knots nearer than this to a pin or to the end of a straight line add nothing but trouble, mm.
[[nodiscard]] double closest_knots(const BandOptions& options);

// `loosen[i]` >= 1 widens the scatter expected at vertex i (the machine needs more room
// there); infinite: only the limit counts. Empty: 1 everywhere. `care`: per edge; empty: none.
[[nodiscard]] FitProblem state_fair_problem(std::span<const Point3> points,
                                            const PathFeatures& features,
                                            std::span<const double> loosen,
                                            std::span<const EdgeRefinement> care,
                                            const BandOptions& options);

// The same for a problem that was stated for these points with these features and options, where
// `loosen` and `care` have changed since then at some vertices, those beside an edge whose care
// changed too: the samples about them are made anew. `changed`: these vertices, in order.
void restate_samples(std::span<const Point3> points, const PathFeatures& features,
                     std::span<const double> loosen, std::span<const EdgeRefinement> care,
                     const BandOptions& options, std::span<const std::size_t> changed,
                     FitProblem& problem);

// The knots that a fair curve starts with. Method: docs/algorithms/fair.md, section Band.

// The knots wished for along the path, in order but for some, and about its corners: in order, none
// inside a zone of `problem`, outside `path` or nearer than `closest` (mm) to the one before. Pins
// and ends of zones stay, and take the place of knots nearer than that.
[[nodiscard]] std::vector<double> knots_of(std::vector<double> along,
                                           std::vector<double> about_corners,
                                           const FitProblem& problem, const ParameterRange& path,
                                           double closest);

}  // namespace batten::geometry
