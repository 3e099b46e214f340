// Curves of least energy in the tube about one curve.
#pragma once

#include <functional>

#include "geometry/fitting/band_curve.h"
#include "geometry/fitting/tube/tube_smoothing.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

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
