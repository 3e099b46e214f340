// The cubic B-spline of least energy that stays in a band: at given parameters its places (or its
// derivatives) keep given distances from given ones. A convex problem, solved by Newton's method
// on a logarithmic barrier: every curve on the way is strictly inside.
// Method: docs/algorithms/band_curve.md.
#pragma once

#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/band_problem.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct BarrierOptions {
  int max_steps = 200;
  // Ends when the energy is known to be above the least one by this part at most.
  double gap = 1e-5;
};

enum class BandEnd {
  kLeast,      // the least energy, to within the gap
  kStepLimit,  // inside the band, but the energy may not be the least
  kOutside,    // no curve on this basis was found that is inside
};

struct BandCurve {
  BsplineCurve curve;
  BandEnd end = BandEnd::kOutside;
  double energy = 0;
  double worst_ratio =
      0;          // the greatest distance over radius at a sample; with a side, at its foot 1
  int steps = 0;  // Newton steps, each linear in samples and control points
};

// `start`: control points to begin with; held points are put where they have to be. It may be
// outside: then the band is widened to hold it and shrunk again, as far as it goes.
//
// Throws std::invalid_argument when the degree is not 3, a radius is not positive, or the number
// of points does not fit the basis.
[[nodiscard]] BandCurve solve_band(const BandProblem& problem, std::vector<Point3> start,
                                   const BarrierOptions& options);

// The curve for which the greatest ratio of distance over radius is least, over the samples with
// a derivative >= `from_derivative`; the others keep their radius (it is widened as well if the
// start is outside). Of the energy only a trace counts. worst_ratio is that greatest ratio, and
// `end` is kLeast when it is known to be the least to within the gap.
[[nodiscard]] BandCurve least_ratio_in_band(const BandProblem& problem, std::vector<Point3> start,
                                            int from_derivative, const BarrierOptions& options);

}  // namespace batten::geometry
