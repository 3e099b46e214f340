// One pass of Naseath's smoother: sizes the moves and makes them (Naseath 2007, chapter 3;
// docs/algorithms/naseath.md, steps 4 and 5). And how hard a curve bends, and which pass is kept
// for it: none of this is in the thesis (the same, the repairs).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/naseath/naseath_polygon.h"
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

class NaseathMover {
 public:
  // Measures the first sensitivities with a mock move by the radius. `setting` must outlive it.
  explicit NaseathMover(const NaseathSetting& setting);

  // Moves the points inside the room given. False when none has anywhere to go.
  bool move(ControlPolygon& polygon, const NaseathRoom& room);

 private:
  [[nodiscard]] std::vector<double> sizes_of(const NaseathRoom& room) const;
  void take_back(ControlPolygon& polygon, const ControlPolygon& before);
  void measure(const std::vector<Vector3>& directions, const std::vector<double>& sizes);

  const NaseathSetting& setting_;
  std::optional<CurvatureGuard> guard_;
  std::vector<double> sensitivities_;
  std::vector<double> parts_;  // of each point's move: halved each time one was taken back
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
