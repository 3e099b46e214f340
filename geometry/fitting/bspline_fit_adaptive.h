// A fit that works only where there is something to do, and that can be made again where its
// problem changed. Method: docs/algorithms/bspline_fit.md.
//
// Every control point rests once it has stopped moving and its samples are inside their limits; it
// wakes when the knots, the samples or the control points beside it change. A solution costs time
// for the control points that are awake and for some neighbours. No place of the run is special:
// what is solved together follows from the curve, and not from windows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/fitting/bspline_fit_system.h"
#include "geometry/fitting/fit_problem.h"

namespace batten::geometry {

class AdaptiveFit {
 public:
  // Fits. Throws std::invalid_argument as fit_bspline does.
  AdaptiveFit(FitProblem problem, const FitOptions& options);

  // Fits another problem on the same interval: the curve stays as it is where the samples, zones
  // and pins are the same, but for what the change moves. `closest` (mm): a pin or the end of a
  // zone takes the place of knots nearer than this.
  void refit(FitProblem problem, double closest);

  [[nodiscard]] const FitSpline& spline() const { return spline_; }

  // Where the curve moved in the last fit: increasing, apart.
  [[nodiscard]] std::vector<ParameterRange> moved() const;

  // Distance over limit of each of these samples, those of the problem; 0 within a zone.
  [[nodiscard]] std::vector<double> ratios(std::span<const FitSample> given) const;

 private:
  // What is known of a control point from one solution to the next.
  struct PointState {
    std::uint8_t left = 0;       // solutions until it rests
    std::uint8_t undecided = 0;  // whether its spans need a knot is not known
    std::uint8_t moved = 0;      // in this fit
    double limit = 0;            // mm, the least of the samples that it holds
  };

  enum class Phase { kDecide, kRelax, kClose };

  void set_breaks(std::vector<double> breaks);
  void set_samples(const std::vector<std::size_t>& now_at);
  void set_rows(const std::vector<std::size_t>& now_at);
  void set_first_samples();
  void set_stiffness();
  void measure_fixed();
  void run();
  void decide_spans();
  void settle();
  template <typename Asks>
  [[nodiscard]] bool split_spans(const Asks& asks);
  void solve(IndexRange free, Phase phase);
  void reweight(IndexRange samples, Phase phase);
  void mark_undecided(IndexRange samples);
  void wake(std::size_t first_point);
  void wake_at(const std::vector<double>& places);
  [[nodiscard]] IndexRange samples_of(IndexRange free) const;
  template <typename IsAwake>
  [[nodiscard]] std::vector<IndexRange> ranges(const IsAwake& is_awake,
                                               std::span<const IndexRange> where) const;
  void add_range(IndexRange awake, std::vector<IndexRange>& found) const;

  FitOptions options_;
  std::vector<FitSample> samples_;  // those outside the zones
  std::vector<StraightZone> zones_;
  std::vector<Pin> pins_;
  FitSpline spline_;
  std::vector<FitRow> rows_;         // per sample
  std::vector<SampleState> states_;  // per sample
  std::vector<std::uint8_t>
      tight_;  // per sample: its weights are still those of a start on new knots
  std::vector<PointState> points_;  // per control point
  std::vector<std::size_t>
      first_sample_;  // per control point, and one more: the first whose row starts there or behind
  bool has_new_breaks_ = true;  // that may be too near to pins and zones
  double closest_ = 0;          // mm, how near that is
  bool out_of_rounds_ = false;  // the last fit ended before all spans were known to do
  FitSystem system_;
};

}  // namespace batten::geometry
