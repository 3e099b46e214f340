// The weights of the samples of a fit: how hard each of them draws the curve.
// Method: docs/algorithms/bspline_fit.md, section Weights.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/fitting/fit_problem.h"

namespace batten::geometry {

// What the fit knows of a sample from one solution to the next.
struct SampleState {
  Point3 target = Point3::Zero();  // slid along the path
  double stiffness = 0;            // of the curve there: what weights are compared with
  double base = 0;                 // weight that makes the distances scatter as expected
  double push = 0;                 // weight of the limit, on top of it
  double distance = 0;             // mm, in the last solution
  double rms = 0;                  // of the distances around over their scatter, one step before
};

// Weights stay above this part of the stiffness, so that a stretch whose samples all have
// room is still held somewhere and the system stays regular; and below this multiple of it:
// heavier weights no longer move the curve where its knots cannot follow.
inline constexpr double kWeightFloor = 1e-8;
inline constexpr double kWeightCap = 1e4;

// In one step a weight grows by this factor at the most. Falling is quicker: distances grow no
// faster than weights fall, so a weight that falls by the ratio does not fall too far.
inline constexpr double kGrowth = 8;
inline constexpr double kFall = 1.0 / 32;

// What is left of the base weight of a sample without scatter after each step: little enough to
// vanish soon, enough for the weights of limits to follow.
inline constexpr double kLetGo = 0.25;

inline double bounded_weight(double weight, double stiffness) {
  return std::clamp(weight, kWeightFloor * stiffness, kWeightCap * stiffness);
}

// Weights close to those of the least-squares curve: they fall from there where there is room.
void start_tight(SampleState& state);

// Sliding along is drawn back by this part in every solution, so that the parameter stays near
// the place it was made for and the curve cannot fold.
inline constexpr double kSlidePull = 0.05;

// No sample slides further than this many limits: the path turns away from its direction.
inline constexpr double kSlideRoom = 2;

// Slides the target to the foot of the curve and measures what is left.
inline void measure(const FitSample& sample, const Point3& on_curve, SampleState& state) {
  const Vector3 off = on_curve - sample.target;
  const double room = kSlideRoom * sample.limit;
  const Vector3 slide = std::clamp(off.dot(sample.along), -room, room) * sample.along;
  state.target = sample.target + (1 - kSlidePull) * slide;
  state.distance = (off - slide).norm();
}

// The distance that weights of limits aim at, in limits: weights approach their values from both
// sides, and a curve that is a little outside is of no use.
inline constexpr double kAimInside = 0.995;

// The discrepancy principle, locally: the base weights of [begin, end[ fall where the distances of
// the neighbourhood are smaller than their scatter and grow where they are greater.
enum class ScatterStep { kBothWays, kGrow };
void reweight_scatter(std::span<const FitSample> samples, std::span<SampleState> states,
                      std::size_t begin, std::size_t end, ScatterStep step);

// Where a limit leaves room its weight falls by the ratio of distance and limit (C. L. Lawson's
// reweighting), so that it vanishes where the limit is not felt.
inline void relax_limit(double ratio, SampleState& state) {
  state.push =
      bounded_weight(state.push * std::clamp(ratio / kAimInside, kFall, 1.0), state.stiffness);
}

// Where a limit is passed its weight takes a part of Newton's step: with leverage h, the compliance
// of the curve at the sample, a weight w leaves a distance proportional to 1 / (w + k),
// k = 1 / h - w, so that w + (ratio - 1) / h would meet the limit if no other sample moved.
void press_limit(double ratio, double leverage, double part, SampleState& state);

// A sample without scatter is held by its limit alone in the end: its base weight fades.
inline void let_go(SampleState& state) {
  state.base = bounded_weight(kLetGo * state.base, state.stiffness);
}

// The limit is told again if need be.
void forget_limit(SampleState& state);

// Whether the samples show that their span cannot follow them: `far` when not even heavier weights
// could help.
struct SpanNeed {
  double worst = 0;  // the greatest distance over its limit
  bool knot = false;
  bool far = false;
};
[[nodiscard]] SpanNeed need_of(std::span<const FitSample> samples,
                               std::span<const SampleState> states);

}  // namespace batten::geometry
