// Curves of least energy in the tube about one curve (tube_smoothing.h), and more knots for them.
#pragma once

#include <functional>

#include "geometry/fitting/band_problem.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

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

class TubeSolver {
 public:
  // On the knots of `curve`.
  TubeSolver(const BsplineCurve& curve, const TubeOptions& options);

  // The curve with the least integral of weight * |C^(energy)|^2, energy 2 or 3.
  [[nodiscard]] BsplineCurve least(int energy, std::function<EnergyWeight(double)> weight);

  // The part of the way from the old curve to `moved`, which has its knots, that is inside the
  // tube at every parameter: all of it, if that is.
  [[nodiscard]] BsplineCurve pulled_inside(const BsplineCurve& moved) const;

  // mm: a bound on |curve(u) - old(u)| for every u.
  [[nodiscard]] double displacement(const BsplineCurve& moved) const;

  [[nodiscard]] const BsplineCurve& original() const { return original_; }

 private:
  BsplineCurve original_;
  double radius_;
  BandProblem problem_;
};

}  // namespace batten::geometry
