// What a method of smoothing makes of a run: one curve, whatever the method.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/fair/fair.h"
#include "geometry/path/bspline_curve.h"
#include "postproc/options/options.h"
#include "postproc/smooth/methods/curve_request.h"

namespace batten::postproc {

struct RunCurve {
  Method method = Method::kFair;
  geometry::SmoothCurve path;  // `noise` and `rounds` are known to `fair` alone, 0 with the others
  std::size_t number = 0;      // among those of a RunMemo
};

// The ends of the run are met exactly. A closed run starts and ends in its seam vertex, where the
// tool is put down and taken up: there is no corner there where the path has none or, with
// Seam::kSmooth, where it is one of two straight lines that may be rounded (geometry::seam_blend;
// not with guo-literal). With the methods of corners every vertex that is not kept gets a blend;
// the lines between stay.
//
// Nothing when the method finds no curve (`racing` where the machine limits neither acceleration
// nor jerk of an axis), and with a side for all methods but `fair`; throws std::invalid_argument
// for Method::kBest and Method::kNone, which are no methods of their own.
[[nodiscard]] std::optional<RunCurve> curve_of(Method method, std::span<const geometry::Point3> run,
                                               const CurveRequest& request);

// The fair curve as long as the run's chords, a little inside the bends of `meant` (the fair curve
// of the run): what takes no more time than the chords. Nothing where there is no room for it.
[[nodiscard]] std::optional<RunCurve> inside_curve(const RunCurve& meant,
                                                   std::span<const geometry::Point3> run,
                                                   CurveRequest request);

// s: from rest to rest along a straight line as long as the curve. No curve of that length takes
// less on a machine with the feed, acceleration and jerk of the request.
[[nodiscard]] double straight_time(const geometry::BsplineCurve& curve,
                                   const CurveRequest& request);

// 1/mm: the greatest of the circles through three neighbouring vertices.
[[nodiscard]] double greatest_curvature(std::span<const geometry::Point3> points);

// How a curve bends, looked at in some points of each span.
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
