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
#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_search.h"

namespace batten::postproc {

// Where a feed plan has its nodes: dense where the machine changes its speed within a short way,
// near rest and around slow places, and sparse where it runs on.

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

// Seconds that these unknowns take over one interval, Simpson's rule on 1 / sqrt(q).
[[nodiscard]] double interval_seconds(double length, const double* window);

// More nodes where those that a plan has are too few.

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
