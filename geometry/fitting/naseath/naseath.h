// Smooths a cubic B-spline inside a tube about it by moving its control points.
//
// Source: G. B. Naseath, MS thesis, Brigham Young University, 2007. The method as the thesis has
// it is `repairs = NaseathRepairs::none()`; what the repairs are for, and what each buys, is in
// docs/algorithms/naseath.md.
//
// What is promised. With `exact_bound` no place of the new curve is further than `radius` from
// the place of the old curve at the same parameter. With `keep_best` the new curve bends at most
// as hard as the old one: its greatest curvature, and its bending, are not above the old ones
// (measured at kNaseathSteps places per span); where no pass is better, the old curve comes back.
// Without them neither holds.
#pragma once

#include <vector>

#include "geometry/fitting/naseath/naseath_setting.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

enum class NaseathStop {
  kTouchesTube,    // nowhere more room than the accuracy
  kPassLimit,      // max_passes
  kStalled,        // stall_passes passes were no better than an earlier one
  kNothingToMove,  // straight or held
};

struct NaseathResult {
  BsplineCurve curve;
  std::vector<double> remaining;  // mm: radius less displacement, before each pass and at the end
  int passes = 0;
  int kept_pass = 0;  // the pass whose curve it is; 0: the old curve
  NaseathStop stop = NaseathStop::kTouchesTube;
  double displacement = 0;  // mm: |new(u) - old(u)| does not exceed it at any u
};

// `curve` is a clamped cubic with single inner knots. The result has its knots.
//
// Throws std::invalid_argument for any other curve, and when radius, accuracy, precision or
// max_passes is not above 0.
[[nodiscard]] NaseathResult smooth_naseath(const BsplineCurve& curve,
                                           const NaseathOptions& options);

}  // namespace batten::geometry
