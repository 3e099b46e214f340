// Smooths a cubic B-spline inside a tube of given radius about it: curves of least energy, and
// the one of them that takes the least time on a machine that the caller knows.
// Method: docs/algorithms/band_curve.md, section Tube.
//
// What is promised. No place of a candidate is further than `radius` from the place of the old
// curve at the same parameter, at every parameter. Among the candidates is the old curve.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "geometry/fitting/tube/tube_smoothing_solver.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

enum class TubeMethod {
  kOriginal,         // the curve as it was
  kNaseath,          // Naseath's smoother, repaired
  kNaseathLiteral,   // and as the thesis has it, scaled back into the tube
  kBending,          // least integral of |C''|^2
  kThirdDerivative,  // least integral of |C'''|^2
  kCurvature,        // least integral of curvature^2 over the length
  kEven,             // the same, with weights raised where the machine has to go slower
  kQuick,            // least estimated time: weights lowered where it has to go slower anyway
  kMixture,          // a weighted mean of others
};

[[nodiscard]] std::string_view name_of(TubeMethod method);

struct TubeCandidate {
  TubeMethod method = TubeMethod::kOriginal;
  int halvings = 0;
  BsplineCurve curve;
  double displacement = 0;  // mm: |new(u) - old(u)| does not exceed it, nor does it the radius
};

// The old curve comes first; the same every time.
//
// Throws std::invalid_argument when the curve is not a clamped cubic with single inner knots, or
// an option is not in the range that TubeOptions gives.
[[nodiscard]] std::vector<TubeCandidate> smooth_in_tube(const BsplineCurve& curve,
                                                        const TubeOptions& options);

// Seconds that the machine takes for a curve.
using CurveTimer = std::function<double(const BsplineCurve&)>;

struct TubeChoice {
  TubeCandidate best;
  double time_before = 0;  // s, of the old curve
  double time = 0;         // s, never above time_before
  int timed = 0;           // calls of the timer
};

// The candidate, or the mixture of candidates, that takes the least time. One that bends harder
// than the old curve somewhere has to be worth it: it must save kWorthBending of the time that
// the best one takes that does not.
[[nodiscard]] TubeChoice best_in_tube(const BsplineCurve& curve, const TubeOptions& options,
                                      const CurveTimer& timer);

inline constexpr double kWorthBending = 0.005;

}  // namespace batten::geometry
