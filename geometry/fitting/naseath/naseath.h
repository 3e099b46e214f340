// Smooths a cubic B-spline inside a tube about it by moving its control points.
//
// Source: G. B. Naseath, MS thesis, Brigham Young University, 2007. The method as the thesis has
// it is `repairs = NaseathRepairs::none()`; what the repairs are for, and what each buys, is in
// docs/algorithms/naseath.md.
//
// What is promised. With `exact_bound` no point of the new curve is further than `radius` from
// the point of the old curve at the same parameter. With `keep_best` the new curve bends at most
// as hard as the old one: its greatest curvature, and its bending, are not above the old ones
// (measured at kNaseathSteps points per span); where no pass is better, the old curve comes back.
// Without them neither holds.
#pragma once

#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct NaseathRepairs {
  // The displacement is bounded, not looked at in `precision` points per span.
  bool exact_bound = true;
  // A section that touched the tube stops, the rest goes on. Needs exact_bound.
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

  [[nodiscard]] static NaseathRepairs none() { return {false, false, false, false, 0, 0}; }
};

struct NaseathOptions {
  double radius = 0.01;    // mm: R, the tube's
  int precision = 5;       // p, points per span at which a displacement is measured
  double accuracy = 0.01;  // a: within this part of the radius is at it
  int max_passes = 2000;   // the literal method need not end by itself
  int held_points = 0;     // control points at each end that do not move:
                           // 1 keeps the ends, 2 the tangents, 3 the curvatures there as well
  NaseathRepairs repairs;
};

struct NaseathTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  // Legs that differ less (sine of the angle) do not turn. A straight end gives three control
  // points on one line to within rounding, and the class of the third must not hang on that.
  double no_turn = 1e-12;       // [<]
  double no_direction = 1e-12;  // mm, or of unit vectors [< Naseath.TurnsWithTheCurveIntoSpace]
  // Part of the move: less, and the quotient is rounding [at 0:
  // Naseath.BendsCurvesHarderLiterallyAndNotWithRepairs].
  double no_influence = 1e-12;
  std::size_t fewest_in_group = 3;  // points
  double apex_share = 9;            // a side point goes with its apex, to one of its own bisector
  // While passes are made a bound on the displacement may exceed it by so much of what `accuracy`
  // resolves.
  double slack = 0.1;
  // The part of the room that moves take. All of it is at the tube to within rounding; this much
  // less and the last bound, too, is inside it.
  double inside = 1 - 1e-6;      // [<]
  double least_part = 1.0 / 64;  // of a move that was taken back: it is halved down to this
  int steps_per_pass = 32;  // a span's, of single passes; the one returned has kNaseathSteps [at 4]
  double same_bending = 1e-9;  // relative: rounding [> Naseath.StaysInTheTubeAndBendsNoHarder]
  double progress = 1e-3;  // relative: a pass that bends less by no more is no progress [at 0.1]
};
inline constexpr NaseathTuning kNaseathTuning;

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
