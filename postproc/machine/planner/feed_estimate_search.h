// The search of the quick estimate: the least time over one stretch, on few nodes.
//
// q = speed^2 is a quadratic spline of the way: q and dq/ds run on, d2q/ds2 is constant over each
// interval. Its unknowns are the Bezier ordinates, q at the start, one in the middle of each
// interval, and q at the end.
#pragma once

#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_estimate_problem.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

// Speed and acceleration along the path at a node.
struct EstimateNode {
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2
};

struct EstimateSolution {
  std::vector<double> ordinates;  // one more than intervals and one: see above
  std::vector<double> seconds;    // of each interval
  double start_seconds = 0;       // of the arcs before and after
  double end_seconds = 0;
  int iterations = 0;
  bool found = false;  // or the search did not come to an end
};

// The limits are asked for in the middle of each interval and, those of joints, at its end.
[[nodiscard]] EstimateSolution quick_search(std::span<const geometry::PathPiece> path,
                                            const EstimateStretch& stretch,
                                            const KinematicPathLimits& limits);

// Between interval `i - 1` and interval `i`.
[[nodiscard]] EstimateNode node_of(const EstimateStretch& stretch, const EstimateSolution& solution,
                                   std::size_t i);

}  // namespace batten::postproc
