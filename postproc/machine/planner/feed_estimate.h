// The planned time of a path, quickly: what plan_feed() would take, within a percent or two, at a
// hundredth of its cost. For a choice between many candidates.
// Method: docs/algorithms/feed_planning.md.
#pragma once

#include <span>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

struct FeedEstimate {
  double time = 0;             // s
  std::vector<double> speeds;  // mm/s at the ends of the pieces, one more than pieces
};

// The same path, limits, ends and stops as plan_feed(). Straight moves from rest to rest have their
// exact time. Elsewhere the limits are kept in the middle of each interval of a grid that is as
// coarse as the estimate allows, so the motion is no plan: between those places it exceeds them.
// Linear cost.
//
// Throws std::invalid_argument as plan_feed() does.
[[nodiscard]] FeedEstimate estimate_feed(std::span<const geometry::PathPiece> path,
                                         const KinematicPathLimits& limits,
                                         const PlanEnds& ends = {});

// Seconds: the time alone.
[[nodiscard]] double estimated_time(std::span<const geometry::PathPiece> path,
                                    const KinematicPathLimits& limits, const PlanEnds& ends = {});

// Requires degree 3 or less.
[[nodiscard]] double estimated_time(const geometry::BsplineCurve& curve,
                                    const KinematicPathLimits& limits, const PlanEnds& ends = {});

}  // namespace batten::postproc
