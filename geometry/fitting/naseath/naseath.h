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

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct NaseathRepairs {
  // The displacement is bounded, not looked at in `precision` places per span.
  bool exact_bound = true;
  // A stretch that touched the tube stops, the rest goes on. Needs exact_bound.
  bool local_stop = true;
  // Points go back where a pass would make the curve bend harder than the old one does in the
  // same span or the next to it; the rest goes on.
  bool guard_curvature = true;
  // Of all passes the one that bends least is returned, not the last one.
  bool keep_best = true;
  // With keep_best: passes without a better curve after which it ends. 0: no such end.
  int stall_passes = 30;
  // Sensitivities count as no less than this, since one tiny value makes all other moves tiny.
  // 0: no floor.
  double sensitivity_floor = 0.3;
  // Ripples and ends do not go past the line through their neighbours.
  bool clamp_moves = false;

  [[nodiscard]] static NaseathRepairs none() { return {false, false, false, false, 0, 0, false}; }
};

struct NaseathOptions {
  double radius = 0.01;    // mm: R, the tube's
  int precision = 5;       // p, places per span at which a displacement is measured
  double accuracy = 0.01;  // a: within this part of the radius is at it
  int max_passes = 2000;   // the literal method need not end by itself
  int held_points = 0;     // control points at each end of an open curve that do not move:
                           // 1 keeps the ends, 2 the tangents, 3 the curvatures there as well
  NaseathRepairs repairs;
};

enum class NaseathStop {
  kTouchesTube,    // nowhere more room than the accuracy
  kPassLimit,      // max_passes
  kStalled,        // stall_passes passes were no better than an earlier one
  kNothingToMove,  // straight, held, or a ring that turns one way all round (moves would shrink it)
};

struct NaseathResult {
  BsplineCurve curve;
  std::vector<double> remaining;  // mm: radius less displacement, before each pass and at the end
  int passes = 0;
  int kept_pass = 0;  // the pass whose curve it is; 0: the old curve
  NaseathStop stop = NaseathStop::kTouchesTube;
  double displacement = 0;  // mm: |new(u) - old(u)| does not exceed it at any u
};

// `curve` is a cubic with single inner knots, either clamped or periodic: a ring whose last three
// control points are its first three, on knots that repeat likewise. The result has its knots.
//
// Throws std::invalid_argument for any other curve, and when radius, accuracy, precision or
// max_passes is not above 0.
[[nodiscard]] NaseathResult smooth_naseath(const BsplineCurve& curve,
                                           const NaseathOptions& options);

// Whether the curve is a ring in the sense above.
[[nodiscard]] bool is_periodic_ring(const BsplineCurve& curve);

}  // namespace batten::geometry
