// More nodes for a feed plan where those that it has are too few.
#pragma once

#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_grid.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_plan_problem.h"

namespace batten::postproc {

struct RefineRule {
  double excess = 0.002;  // an interval is cut where it exceeds a limit by this part of it,
  double switching = 2;   // or where the jerk (without jerk limit the acceleration) along the path
                          // changes by this part of its limit; above 2: never
};

// Cuts intervals in two; x becomes the unknowns of the same speeds on the new grid. Returns how
// many were cut.
std::size_t refine_plan(std::span<const geometry::PathPiece> pieces,
                        const KinematicPathLimits& limits, const PlanProblem& problem,
                        const RefineRule& rule, PlanGrid& grid, std::vector<double>& x);

}  // namespace batten::postproc
