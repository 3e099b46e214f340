// What a method of smoothing makes of a run: one curve, whatever the method.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/fitting/fair/fair.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/kinematic_feed.h"
#include "postproc/machine/machine.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct RunCurve {
  Method method = Method::kFair;
  geometry::SmoothCurve path;  // `noise` and `rounds` are known to `fair` alone, 0 with the others
  std::size_t number = 0;      // among those of a RunMemo
};

struct CurveRequest {
  double tolerance = 0.01;  // mm, curve to run
  geometry::ToleranceKind kind = geometry::ToleranceKind::kPath;
  geometry::Side side = geometry::Side::kBoth;
  double side_margin = 0;            // mm, see geometry::OneSidedOptions
  double rounding = 0.0005;          // mm, greatest error of one printed coordinate of the run
  double keep_corner_angle = 3.2;    // radians: vertices that turn more stay as they are
  double keep_found_corner = 3.2;    // radians: see geometry::FairOptions
  geometry::KinematicLimits limits;  // what the machine can do at the greatest feed of the run
  double jerk = std::numeric_limits<double>::infinity();  // mm/s^3, see geometry::FairOptions
  double scatter = 0;                                     // mm, see geometry::FairOptions
  bool accurate = false;                                  // see geometry::FairOptions
  bool near = true;                                       // the same
  double guo_lambda = 0;                                  // see geometry::GuoOptions
  geometry::Seam seam = geometry::Seam::kCorner;          // of a closed run
};

[[nodiscard]] double greatest_feed(const Run& run);  // mm/min

// `feed`: mm/min, programmed. Where the machine has no jerk limit, it is infinite.
[[nodiscard]] geometry::KinematicLimits limits_of(const Machine& machine, double feed);

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

[[nodiscard]] std::optional<geometry::SmoothCurve> fair_curve(std::span<const geometry::Point3> run,
                                                              const CurveRequest& request);

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
