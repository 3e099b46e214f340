// What is asked of a method of smoothing, and the fair curve, which several of them begin with.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/basic/tolerance_kind.h"
#include "geometry/fitting/fair/fair.h"
#include "geometry/path/kinematic_feed.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"

namespace batten::postproc {

struct CurveRequest {
  double tolerance = 0.01;  // mm, curve to run
  geometry::ToleranceKind kind = geometry::ToleranceKind::kPath;
  geometry::Side side = geometry::Side::kBoth;
  double side_margin = 0;            // mm, see geometry::OneSidedOptions
  double rounding = 0.0005;          // mm, greatest error of one printed coordinate of the run
  double keep_corner_angle = 3.2;    // radians: vertices that turn more stay as they are
  double keep_found_corner = 3.2;    // radians: see geometry::FairOptions
  geometry::KinematicLimits limits;  // what the machine can do at the greatest feed of the run
  double jerk = std::numeric_limits<double>::infinity();   // mm/s^3, see geometry::FairOptions
  double scatter = 0;                                      // mm, see geometry::FairOptions
  bool accurate = false;                                   // see geometry::FairOptions
  bool near = true;                                        // the same
  double guo_lambda = 0;                                   // see geometry::GuoOptions
  geometry::Seam seam = geometry::Seam::kCorner;           // of a closed run
  double rival = std::numeric_limits<double>::infinity();  // s, see tube_curve
};

[[nodiscard]] double greatest_feed(const Run& run);  // mm/min

// `feed`: mm/min, programmed. Where the machine has no jerk limit, it is infinite.
[[nodiscard]] geometry::KinematicLimits limits_of(const Machine& machine, double feed);

// What a plan of a curve has to keep.
[[nodiscard]] KinematicPathLimits plan_limits(const CurveRequest& request);

// Whether the machine has a feed, and limits the acceleration or the jerk of each axis: what a plan
// of the least time needs to know.
[[nodiscard]] bool can_race(const geometry::KinematicLimits& limits);

[[nodiscard]] std::optional<geometry::SmoothCurve> fair_curve(std::span<const geometry::Point3> run,
                                                              const CurveRequest& request);

}  // namespace batten::postproc
