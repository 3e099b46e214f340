// A feed plan as a problem of the search (feed_search.h) over a grid.
//
// q = (ds/dt)^2 is a cubic on each interval between two nodes, given by q and p = dq/ds at both, so
// speed and acceleration are continuous and the jerk may jump at nodes. The windows below are the
// four unknowns (q0, p0, q1, p1) of one interval.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_grid.h"
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_search.h"

namespace batten::postproc {

// q, dq/ds and d2q/ds2 themselves.
struct PlanState {
  double q = 0;
  double p = 0;
  double r = 0;
};

// `s` mm after the start of an interval.
[[nodiscard]] PlanState state_in(const double* window, double length, double s);

// An end of the path at rest: from there to the first unknown node, `length` mm away, the speed
// grows with a power of the way (2/3 where the jerk is limited, else 1/2), which constant jerk (or
// acceleration) gives. So p = 2 power q / length, and the time is length / ((1 - power) v).
// No rest where length is 0.
struct PlanRest {
  double length = 0;
  double power = 2.0 / 3;

  [[nodiscard]] double slope() const { return length > 0 ? 2 * power / length : 0; }
  [[nodiscard]] double time() const { return length / (1 - power); }  // times 1 / v

  // mm/s^2, for q at the node: half of dq/ds, where the power leaves one.
  [[nodiscard]] double acceleration_at_rest(double q) const {
    return power > 0.5 ? 0 : 0.5 * q / length;
  }
};

// Limits are asked for at both ends and in the middle of each interval.
struct PlanProblem {
  SearchProblem search;
  std::vector<double> lengths;  // mm, of the intervals
  PlanRest start;
  PlanRest end;

  [[nodiscard]] std::size_t intervals() const { return lengths.size(); }
};

[[nodiscard]] PlanProblem make_plan_problem(std::span<const geometry::PathPiece> pieces,
                                            const PlanGrid& grid,
                                            const KinematicPathLimits& limits);

// Unknowns to start the search from: the grid's rough speeds, smoothed. They exceed limits.
[[nodiscard]] std::vector<double> rough_start(const PlanProblem& problem, const PlanGrid& grid);

// The search asks of its start that speed^2 is above 0 at all places. A cubic between nodes that
// were added may not be: there the slopes at its ends become those of a monotone one. False where
// that does not help.
[[nodiscard]] bool raise_above_zero(const PlanProblem& problem, std::vector<double>& x);

// The parameter of the place in the middle of an interval, by length.
[[nodiscard]] double middle_of(const geometry::PathPiece& piece, const GridInterval& interval);

// Seconds that these unknowns take over one interval, Simpson's rule on 1 / sqrt(q).
[[nodiscard]] double interval_seconds(double length, const double* window);

}  // namespace batten::postproc
