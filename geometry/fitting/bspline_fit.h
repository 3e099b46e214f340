// The smoothest cubic B-spline that keeps given distances from given places, on few knots.
// Method: docs/algorithms/bspline_fit.md. A fit whose problem changes here and there is made
// again by AdaptiveFit (bspline_fit_adaptive.h).
//
// At the parameter of each sample the curve passes its target at a distance, measured across
// the sample's direction (sliding along it is free). Of the curves whose distances scatter
// locally as the samples are expected to, and stay below their limits, this is the one with
// the least integral of |C'''|^2 over the parameter.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct FitSample {
  double parameter = 0;
  Point3 target = Point3::Zero();
  Vector3 along =
      Vector3::Zero();  // unit direction of free sliding; zero: the full distance counts
  double limit = 0;     // mm, > 0: no distance is greater
  double scatter = 0;   // mm, rms distance expected here; 0: only the limit counts
};

// The curve is exactly the straight line from `start` to `end` over [from, to], run at even
// speed, and so are its first two derivatives at both ends.
struct StraightZone {
  double from = 0;
  double to = 0;
  Point3 start = Point3::Zero();
  Point3 end = Point3::Zero();
};

// The curve passes here exactly, and may have a corner.
struct Pin {
  double parameter = 0;
  Point3 place = Point3::Zero();
};

struct FitProblem {
  std::vector<FitSample> samples;   // parameters increase
  std::vector<StraightZone> zones;  // do not overlap, in order
  std::vector<Pin> pins;            // in order; first and last are the ends of the curve
  std::vector<double> breakpoints;  // where spans start at first, strictly increasing, with the
                                    // ends, every pin and every end of a zone; none inside a zone
};

struct FitOptions {
  int max_refinements = 10;  // rounds of splitting the spans that cannot hold their samples
  int passes = 8;            // solutions per round that tell which spans those are
  int last_passes = 16;      // solutions, when weights have settled, to bring all inside
};

struct BsplineFit {
  BsplineCurve curve;
  std::vector<double> ratios;  // per sample: distance over limit; <= 1 where it is kept
  double worst_ratio = 0;
};

// Always returns a curve; worst_ratio says whether it keeps the limits. Linear time.
// Requires two pins or more and the order promised above.
[[nodiscard]] BsplineFit fit_bspline(const FitProblem& problem, const FitOptions& options);

}  // namespace batten::geometry
