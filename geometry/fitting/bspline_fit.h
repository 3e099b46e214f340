// The smoothest cubic B-spline that keeps given distances from given points, on few knots.
// Method: docs/algorithms/bspline_fit.md. A fit whose problem changes here and there is made
// again by PartedFit.
//
// At the parameter of each sample the curve passes its target at a distance, measured across
// the sample's direction (sliding along it is free). Of the curves whose distances scatter
// locally as the samples are expected to, and stay below their limits, this is the one with
// the least integral of |C'''|^2 over the parameter.
#pragma once

#include <span>
#include <vector>

#include "geometry/fitting/bspline_fit_system.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

struct BsplineFit {
  BsplineCurve curve;
  std::vector<double> ratios;  // per sample: distance over limit; <= 1 where it is kept
  double worst_ratio = 0;
};

// Always returns a curve; worst_ratio says whether it keeps the limits. Linear time.
// Requires two pins or more and the order that FitProblem promises.
[[nodiscard]] BsplineFit fit_bspline(const FitProblem& problem,
                                     int max_refinements = kFitTuning.max_refinements);

class AdaptiveFit;

// A fit in parts that do not know of each other: pins and straight zones part the curve, for
// whatever happens on one side of them does not move the other.
class PartedFit {
 public:
  // Fits. Throws std::invalid_argument as fit_bspline does.
  PartedFit(const FitProblem& problem, int max_refinements = kFitTuning.max_refinements);

  PartedFit(const PartedFit& other);
  PartedFit(PartedFit&& other) noexcept;
  PartedFit& operator=(const PartedFit& other);
  PartedFit& operator=(PartedFit&& other) noexcept;
  ~PartedFit();

  // Fits another problem on the same interval, and works only where it differs. `closest` (mm): a
  // pin or the end of a zone replaces knots nearer than this.
  void refit(const FitProblem& problem, double closest);

  [[nodiscard]] const FitSpline& spline() const { return spline_; }
  [[nodiscard]] BsplineCurve curve() const;

  // Where the curve moved in the last fit: increasing, apart.
  [[nodiscard]] std::vector<ParameterRange> moved() const;

  // Distance over limit of each of these samples, those of the problem; 0 within a zone.
  [[nodiscard]] std::vector<double> ratios(std::span<const FitSample> given) const;

 private:
  void start(const FitProblem& problem);
  [[nodiscard]] std::vector<Pin> ends_of_parts(const FitProblem& problem) const;
  void assemble(const FitProblem& problem);

  int max_refinements_;
  std::vector<double> borders_;  // between the parts, and both ends
  std::vector<AdaptiveFit> parts_;
  FitSpline spline_;  // of the parts in a row, with these pins and zones
  std::vector<Pin> pins_;
  std::vector<StraightZone> zones_;
};

}  // namespace batten::geometry
