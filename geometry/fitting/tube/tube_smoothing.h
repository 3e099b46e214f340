// Smooths a cubic B-spline inside a tube of given radius about it: curves of least energy, and
// the one of them that takes the least time on a machine that the caller knows.
// Method: docs/algorithms/band_curve.md, section Tube.
//
// What is promised. At every parameter a candidate is no further than `radius` from the old curve
// at the same parameter. Among the candidates is the old curve.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct TubeTuning {
  // Rounds of weighting by the curve of the round before. After some of them a candidate is taken:
  // the first changes most, the last has settled.
  int rounds = 9;
  bool is_taken(int round) const { return round == 1 || round == 3 || round == rounds; }
  // The time at the speed min(V, sqrt(A/kappa)), with the corner between the two rounded, is the
  // integral of (1/V^4 + (kappa/A)^2)^(1/4) ds. As a function of kappa^2 it is concave, so its
  // tangent, which has this power, is above it: lowering the integral of tangent slope times
  // kappa^2 lowers the time, and the tangent is taken anew each round. (A local least: it depends
  // on the start.)
  double quick_power = -0.75;
  double raise = 0.5;  // power of what is too much, in the next weight; with more it would swing
  int curvature_samples = 8;  // per span, for weights
  int curvature_steps = 64;   // per span, to compare the greatest
  double least_speed = 1e-3;  // a parameter that hardly moves has no curvature to speak of
  // Per span, where the band is watched. What is missed between them, under a percent, is taken
  // back by pulled_inside; energies need not be nearer to the least than that (gap).
  int watched = 6;
  double gap = 1e-3;
  double slack = 1e-4;        // the bound on a displacement may be this part of the radius too high
  std::size_t mixed = 4;      // candidates that a mixture is made of, at most
  int mixtures = 100;         // that are timed, at most
  double first_share = 0.25;  // steps of the shares of a mixture
  double finest_share = 0.01;  // in parts of the first
  double worth_moving = 1e-6;  // a gain that is less than this part of the time is none
  // Part of the time that a curve has to save which bends harder than the old one somewhere.
  double worth_bending = 0.005;
  double same_curvature = 1e-9;  // a curvature above the old one's by less is rounding
};
inline constexpr TubeTuning kTubeTuning;

struct TubeOptions {
  double radius = 0.01;  // mm, > 0
  // Control points at each end that stay: 1 keeps the ends, 2 the directions, 3 the curvatures
  // there as well. 0: the ends may slide across the tube.
  int held_points = 0;
  // The feed that is wanted, and what the machine can give across the path: where local weights
  // come from.
  double feed = 400;           // mm/s
  double acceleration = 4000;  // mm/s^2
  // Spans are halved this often, where more knots may help: 0 keeps the knots. Candidates come
  // for each number of halvings up to it.
  int halvings = 2;
};

// The same curve with a knot in the middle of every span, `times` times. Requires degree 3.
// Linear cost.
[[nodiscard]] BsplineCurve with_spans_halved(const BsplineCurve& curve, int times);

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

// The candidates that win most for their cost: the least integrals of |C'''|^2, whose curve is
// nearly as fast as the best of them, and of |C''|^2, the old curve, and after the first
// one round of curvature and one of estimated time.
inline constexpr std::array kFewMethods = {TubeMethod::kThirdDerivative, TubeMethod::kBending,
                                           TubeMethod::kOriginal, TubeMethod::kCurvature,
                                           TubeMethod::kQuick};

struct FewInTube {
  std::vector<TubeCandidate> candidates;  // one for each method, in their order
  // Of all solutions, Newton steps times the samples that each step visits.
  std::size_t visits = 0;
};

// Candidates of `methods`, which are some of kFewMethods, on the knots of the curve; the same of a
// method whichever others are asked for. Each but the old curve costs a solution of solve_band, and
// the last two that of the first, too, once: of kTubeTuning.watched samples for a span and of at
// most kBandTuning.max_steps steps. `options.halvings` is not looked at.
//
// `third`: the curve by kThirdDerivative, where it is at hand.
//
// Throws as smooth_in_tube does, and for another method.
[[nodiscard]] FewInTube few_in_tube(const BsplineCurve& curve, const TubeOptions& options,
                                    std::span<const TubeMethod> methods = kFewMethods,
                                    const std::optional<BsplineCurve>& third = {});

// Seconds that the machine takes for a curve.
using CurveTimer = std::function<double(const BsplineCurve&)>;

struct TubeChoice {
  TubeCandidate best;
  double time_before = 0;  // s, of the old curve
  double time = 0;         // s, never above time_before
  int timed = 0;           // calls of the timer
};

// The candidate, or the mixture of candidates, that takes the least time. One that bends harder
// than the old curve somewhere has to be worth it: it must save kTubeTuning.worth_bending of the
// time that the best one takes that does not.
[[nodiscard]] TubeChoice best_in_tube(const BsplineCurve& curve, const TubeOptions& options,
                                      const CurveTimer& timer);

}  // namespace batten::geometry
