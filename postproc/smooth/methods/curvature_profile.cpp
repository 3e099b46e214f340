#include "postproc/smooth/methods/curvature_profile.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/fitting/fair/fair_measure.h"

namespace batten::postproc {

CurvatureProfile::CurvatureProfile(const geometry::BsplineCurve& curve) {
  constexpr int kParts = 8;
  geometry::SplineWalk walk(curve.basis().knots(), curve.control_points());
  const std::vector<double> knots = curve.breakpoints();
  steps_.reserve(kParts / 2 * knots.size());
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double span = knots[i + 1] - knots[i];
    for (int k = 0; k < kParts; ++k) {
      const double curvature = walk.curvature_at(knots[i] + span * k / kParts);
      greatest_ = std::max(greatest_, curvature);
      // The odd ones are in the middle of a quarter. The parameter is about the length.
      if (k % 2 == 1) steps_.push_back({2 * span / kParts, std::sqrt(curvature)});
    }
  }
  greatest_ = std::max(greatest_, walk.curvature_at(curve.last()));
}

double CurvatureProfile::chords(double deviation, double min_length) const {
  const double per_bend = 1 / std::sqrt(8 * deviation);
  double chords = 0;
  for (const Step& step : steps_) {
    const double per_mm = per_bend * step.bend;
    chords += step.length * (per_mm * min_length > 1 ? std::sqrt(0.5) * per_mm : per_mm);
  }
  return chords;
}

}  // namespace batten::postproc
