// The search for the fastest feed along a path, as an optimisation over a grid.
//
// q = (ds/dt)^2 is a cubic on each interval between two nodes, given by q and p = dq/ds at both, so
// speed and acceleration are continuous and the jerk may jump at nodes. The windows below are the
// four unknowns (q0, p0, q1, p1) of one interval.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_grid.h"
#include "postproc/machine/planner/feed_plan_limits.h"
#include "postproc/machine/planner/feed_plan_rows.h"

namespace batten::postproc {

using PlanWindow = std::array<double, 4>;

// q, dq/ds and d2q/ds2 themselves.
struct PlanState {
  double q = 0;
  double p = 0;
  double r = 0;
};

// `s` mm after the start of an interval.
[[nodiscard]] PlanState state_in(const double* window, double length, double s);

// Places of an interval at which limits are asked for: its start, its middle, its end.
inline constexpr std::size_t kPlanPlaces = 3;

// The states at those places.
[[nodiscard]] std::array<PlanState, kPlanPlaces> states_at_places(const double* window,
                                                                  double length);

// The limits at one place: rows |c.(q, p, r)| <= 1, those of the jerk (<= 1 / sqrt(q)) first, and a
// bound of q.
struct PlanPlace {
  std::size_t first_row = 0;
  std::size_t jerk_rows = 0;
  std::size_t rows = 0;
  double most = KinematicPathLimits::kNone;  // mm^2/s^2
};

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

struct PlanProblem {
  std::vector<double> lengths;    // mm, of the intervals
  std::vector<LimitWindow> rows;  // c of each row, those of one place side by side
  std::vector<PlanPlace> places;  // kPlanPlaces for each interval
  PlanRest start;
  PlanRest end;
  bool start_is_given = false;  // q and p there are those of the start of the search
  bool end_is_given = false;

  [[nodiscard]] std::size_t intervals() const { return lengths.size(); }
  [[nodiscard]] std::size_t unknowns() const { return 2 * lengths.size() + 2; }
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

// The same unknowns, slowed down as a whole until they keep all limits. Any q that keeps all limits
// keeps them times a factor below 1.
void slow_down(const PlanProblem& problem, std::vector<double>& x);

// The parameter of the place in the middle of an interval, by length.
[[nodiscard]] double middle_of(const geometry::PathPiece& piece, const GridInterval& interval);

// Seconds that these unknowns take, Simpson's rule on 1 / sqrt(q); of one interval, and in all.
[[nodiscard]] double interval_seconds(double length, const double* window);
[[nodiscard]] double planned_seconds(const PlanProblem& problem, std::span<const double> x);

}  // namespace batten::postproc
