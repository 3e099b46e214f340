// How hard a curve bends, and which pass of Naseath's smoother is kept for it. None of this is
// in the thesis: docs/algorithms/naseath.md, the repairs.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/fitting/naseath/naseath_categories.h"
#include "geometry/fitting/naseath/naseath_setting.h"

namespace batten::geometry {

// Knows how hard a span may bend: as hard as it or one of its neighbours did in the old curve.
class CurvatureGuard {
 public:
  // `setting` must outlive the guard.
  explicit CurvatureGuard(const NaseathSetting& setting);

  // The spans of the polygon's curve that bend harder, in order.
  [[nodiscard]] std::vector<std::size_t> broken(const ControlPolygon& polygon) const;

 private:
  const NaseathSetting& setting_;
  std::vector<double> limits_;  // 1/mm, per span
};

struct Fairness {
  double max_curvature = 0;  // 1/mm
  double bending = 0;        // 1/mm, the integral of curvature^2 over the length

  [[nodiscard]] bool no_worse_than(const Fairness& other) const;
};

// The pass that bends least among those that are no worse than the old curve.
class BestPass {
 public:
  // Starts with pass 0, the old curve. `setting` must outlive it.
  explicit BestPass(const NaseathSetting& setting);

  void offer(const ControlPolygon& polygon, int pass);

  // Measures what is kept once more, at kNaseathSteps; goes back to pass 0 where that disagrees.
  void confirm();

  [[nodiscard]] const ControlPolygon& polygon() const { return polygon_; }
  [[nodiscard]] int pass() const { return pass_; }
  [[nodiscard]] int last_progress() const { return last_progress_; }  // a pass

 private:
  [[nodiscard]] Fairness fairness_of(const ControlPolygon& polygon, int steps) const;

  const NaseathSetting& setting_;
  Fairness old_;
  ControlPolygon polygon_;
  int pass_ = 0;
  double bending_ = 0;   // of polygon_
  double progress_ = 0;  // bending at the last pass that was better by kProgress
  int last_progress_ = 0;
};

}  // namespace batten::geometry
