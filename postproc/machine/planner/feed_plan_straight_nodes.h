// Where the plan of a straight move has its nodes.
#pragma once

#include <vector>

#include "postproc/machine/planner/feed_plan_limits.h"
#include "postproc/machine/planner/feed_plan_straight.h"

namespace batten::postproc {

// Seconds, rising, the end of the move included: where the jerk changes, `density` places between
// those, and at `ends`, the distances of the ends of its pieces in mm.
[[nodiscard]] std::vector<double> node_times(const StraightMove& move,
                                             const std::vector<double>& ends, double density);
[[nodiscard]] std::vector<double> node_times(const StraightRun& run, const LimitsAlong& limits,
                                             const std::vector<double>& ends, double density);

}  // namespace batten::postproc
