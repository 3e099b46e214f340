// Where a feed plan has its nodes: dense where the machine changes its speed within a short way,
// near rest and around slow places, and sparse where it runs on.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

// A part of one piece between two neighbouring nodes.
struct GridInterval {
  std::size_t piece = 0;
  double t0 = 0;
  double t1 = 1;
  double length = 0;  // mm
};

struct PlanGrid {
  std::vector<GridInterval> intervals;
  std::vector<double> bounds;  // mm/s at each node: what its joint allows, mostly infinity
  std::vector<double> speeds;  // mm/s at each node: a rough upper bound
  bool slow_start = false;     // the bound there is the speed, and the acceleration is 0
  bool slow_end = false;
};

// Nodes for pieces of some length that are run without a stop between them. `bounds` are the
// greatest speeds at their ends (one more than pieces, mm/s; 0 only at the first and the last:
// rest). `density` is the number of nodes in the time sqrt(v / jerk), half of what the machine
// needs for a change of its speed by v.
[[nodiscard]] PlanGrid make_plan_grid(std::span<const geometry::PathPiece> pieces,
                                      std::span<const double> bounds,
                                      const KinematicPathLimits& limits, double density);

}  // namespace batten::postproc
