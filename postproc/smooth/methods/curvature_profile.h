// How much a curve bends, and about how many chords that makes.
#pragma once

#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::postproc {

// How a curve bends, looked at in some places of each span.
class CurvatureProfile {
 public:
  explicit CurvatureProfile(const geometry::BsplineCurve& curve);

  // 1/mm: the greatest curvature there.
  [[nodiscard]] double greatest() const { return greatest_; }

  // About how many chords within `deviation` (mm) the curve takes, where chords shorter than
  // `min_length` (mm) may be twice as far off.
  [[nodiscard]] double chords(double deviation, double min_length) const;

 private:
  struct Step {
    double length;  // mm
    double bend;    // the root of the curvature
  };
  std::vector<Step> steps_;  // a few for each span
  double greatest_ = 0;
};

}  // namespace batten::postproc
