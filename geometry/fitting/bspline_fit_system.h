// The cubic spline of a fit while it is made: its knots, what is known of its control points, its
// energy, and the basis values at the samples. And the normal equations for a range of its control
// points, all others held where they are.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/fit_problem.h"
#include "geometry/numeric/banded_cholesky.h"

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

struct FitSpline {
  std::vector<double> breaks;       // distinct knots, increasing
  std::vector<double> knots;        // fourfold at the ends, threefold at inner pins
  std::vector<Point3> points;       // control points
  std::vector<std::uint8_t> fixed;  // per control point: its place is known, by a pin or a zone

  // Integrals of the products of third derivatives: energy[i][k] belongs to i and i - k.
  std::vector<std::array<double, 4>> energy;

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

// The spline on these breakpoints; control points that are not fixed are at the origin. Throws
// std::invalid_argument when a pin or the end of a zone is no breakpoint.
[[nodiscard]] FitSpline spline_on(std::vector<double> breaks, std::span<const Pin> pins,
                                  std::span<const StraightZone> zones);

inline constexpr std::size_t kNotCarried = static_cast<std::size_t>(-1);

// Takes over the control points of `before` whose knots are the same in `after`; a place that is
// fixed in one of them has to be so in the other. Gives the new index of every old one, or
// kNotCarried.
[[nodiscard]] std::vector<std::size_t> carry_points(const FitSpline& before, FitSpline& after);

// The four basis functions that are not zero at a sample.
struct FitRow {
  std::size_t first = 0;  // the first of four control points
  std::array<double, 4> value{};
};

// The row at u, on the last span from `span` on that does not start behind it; `span` moves there.
[[nodiscard]] FitRow row_at(const FitSpline& spline, double u, std::size_t& span);

// The curve at a sample.
[[nodiscard, gnu::always_inline]] inline Point3 place_of(const FitRow& row,
                                                         std::span<const Point3> points) {
  const Point3* p = &points[row.first];
  return row.value[0] * p[0] + row.value[1] * p[1] + row.value[2] * p[2] + row.value[3] * p[3];
}

// Indices [begin, end[.
struct IndexRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

// The normal equations. Memory is kept from one solution to the next.
class FitSystem {
 public:
  // Minimises energy + sum of weight * |curve - target|^2 over the control points `free`.
  // `samples` are those whose rows touch them. Returns false when the system is singular.
  [[nodiscard]] bool solve(const FitSpline& spline, std::span<const FitRow> rows,
                           std::span<const SampleState> states, IndexRange samples,
                           IndexRange free);

  // After solve(): the new place of a control point of `free`.
  [[nodiscard]] const Point3& place(std::size_t point) const { return right_[point - offset_]; }

  // After solve(): the inverse, as far as leverage() needs it for rows that start at `first_point`
  // or behind.
  void invert(const FitSpline& spline, std::size_t first_point);

  // After invert(): the compliance of the curve at a sample, how far a unit force moves it.
  [[nodiscard]] double leverage(const FitRow& row) const;

 private:
  void add_samples(std::span<const FitRow> rows, std::span<const SampleState> states,
                   IndexRange samples);
  void add_sample(const FitRow& row, const SampleState& state);
  [[nodiscard]] bool is_held(const FitSpline& spline, std::size_t point) const {
    return point < free_.begin || point >= free_.end || spline.fixed[point] != 0;
  }

  BandedMatrix matrix_{0};
  BandedMatrix inverse_{0};
  std::vector<Point3> right_;
  std::size_t offset_ = 0;  // control point of the first row
  IndexRange free_;
};

}  // namespace batten::geometry
