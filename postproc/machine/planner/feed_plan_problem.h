// The search for the fastest feed along a path, as an optimisation over a grid.
//
// q = (ds/dt)^2 is a cubic on each interval between two nodes, given by q and p = dq/ds at both, so
// speed and acceleration are continuous and the jerk may jump at nodes. The windows below are the
// four unknowns (q0, p0, q1, p1) of one interval.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_grid.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

using LimitWindow = std::array<double, 3>;

// c.x <= 1 and -c.x <= 1.
using LimitSides = Eigen::Array2d;

struct LimitRow {
  LimitWindow c{};
  LimitSides slack = LimitSides::Ones();
  LimitSides dual = LimitSides::Zero();
  LimitSides inverse = LimitSides::Ones();  // of the slack
  LimitSides missing = LimitSides::Zero();  // what the unknowns leave, less the slack
  LimitSides slack_step = LimitSides::Zero();
  LimitSides dual_step = LimitSides::Zero();
};

// q <= most, for one q.
struct LimitBound {
  double scale = 0;  // 1 / most, s^2/mm^2
  double slack = 1;  // as part of `most`
  double dual = 0;
  double inverse = 1;  // of the slack
  double missing = 0;
  double slack_step = 0;
  double dual_step = 0;

  [[nodiscard]] bool is_there() const { return scale > 0; }
};

// What the rows of a place add to the system of one step.
struct LimitSums {
  std::array<double, 6> square{};  // qq, pq, pp, rq, rp, rr
  LimitWindow base{};              // the right side, for a target of 0
  LimitWindow center{};            // what a target of 1 adds to it
  LimitWindow unexplained{};       // gradient of the time, and of the limits times their duals

  // The time so many mm / sqrt(q), given 1 / sqrt(q).
  void add_time(double length, double root) {
    const double inverse = root * root;
    const double slope = -0.5 * length * root * inverse;
    square[0] -= 1.5 * slope * inverse;
    base[0] -= slope;
    unexplained[0] += slope;
  }
};

// Over all rows.
struct LimitTally {
  LimitSides gap = LimitSides::Zero();  // s: slack * dual, summed in two halves
  double excess = 0;                    // the greatest part of its limit that a row is above it
  double sides = 0;

  void start() {
    gap.setZero();
    excess = 0;
  }
  [[nodiscard]] double whole_gap() const { return gap.sum(); }
};

// Reciprocals of how far a step may go, times how near to a limit it may come.
struct LimitReach {
  double primal;
  LimitSides slack;
  LimitSides dual;

  explicit LimitReach(double to_limit)
      : primal(to_limit),
        slack(LimitSides::Constant(to_limit)),
        dual(LimitSides::Constant(to_limit)) {}

  [[nodiscard]] double greatest_primal() const { return std::max(primal, slack.maxCoeff()); }
  [[nodiscard]] double greatest_dual() const { return dual.maxCoeff(); }
};

[[nodiscard]] inline double dot(const LimitWindow& c, const LimitWindow& x) {
  return c[0] * x[0] + c[1] * x[1] + c[2] * x[2];
}

inline void add_scaled(LimitWindow& sum, double w, const LimitWindow& c) {
  sum[0] += w * c[0];
  sum[1] += w * c[1];
  sum[2] += w * c[2];
}

// --- the start ----------------------------------------------------------------------------------

// All products slack * dual alike; slacks no less than `least` times the limit.
inline void start_row(LimitRow& row, const LimitWindow& x, double right, double least,
                      double product) {
  const double left = dot(row.c, x);
  row.slack = LimitSides(right - left, right + left).max(least * right);
  row.dual = product / row.slack;
}

inline void start_bound(LimitBound& bound, double q, double least, double product) {
  if (!bound.is_there()) return;
  bound.slack = std::max(1 - q * bound.scale, least);
  bound.dual = product / bound.slack;
}

// --- one step -----------------------------------------------------------------------------------

// What the sides of rows sum to that stand on the tangent of 1 / sqrt(q).
struct TangentSums {
  LimitSides square = LimitSides::Zero();
  LimitSides base = LimitSides::Zero();
  LimitSides center = LimitSides::Zero();
  LimitSides dual = LimitSides::Zero();
  LimitWindow mixed{};
};

// Goes these shares of the last step and adds what is needed for the next.
template <bool kJerk, bool kExplain>
inline void add_row(LimitRow& row, const LimitWindow& x, double right, double primal, double dual,
                    LimitSums& sums, TangentSums& tangent, LimitSides& room, LimitTally& tally) {
  const LimitWindow& c = row.c;
  const double left = dot(c, x);
  const LimitSides slack = row.slack + primal * row.slack_step;
  const LimitSides duals = row.dual + dual * row.dual_step;
  const LimitSides here(right - left, right + left);
  const LimitSides missing = here - slack;
  const LimitSides inverse = slack.inverse();
  const LimitSides weight = duals * inverse;
  const LimitSides toward = weight * missing;
  row.slack = slack;
  row.dual = duals;
  row.missing = missing;
  row.inverse = inverse;
  room = room.min(here);
  tally.gap += slack * duals;
  const double both = weight[0] + weight[1];
  const LimitWindow scaled = {both * c[0], both * c[1], both * c[2]};
  sums.square[0] += scaled[0] * c[0];
  sums.square[1] += scaled[1] * c[0];
  sums.square[2] += scaled[1] * c[1];
  sums.square[3] += scaled[2] * c[0];
  sums.square[4] += scaled[2] * c[1];
  sums.square[5] += scaled[2] * c[2];
  add_scaled(sums.base, toward[0] - toward[1], c);
  add_scaled(sums.center, inverse[1] - inverse[0], c);
  if constexpr (kExplain) add_scaled(sums.unexplained, duals[0] - duals[1], c);
  if constexpr (kJerk) {
    tangent.square += weight;
    tangent.base += toward;
    tangent.center += inverse;
    if constexpr (kExplain) tangent.dual += duals;
    add_scaled(tangent.mixed, weight[0] - weight[1], c);
  }
}

// All rows of a place; the first `jerk_rows` are those of the jerk, root = 1 / sqrt(q). Without
// kExplain the gradient is not summed.
template <bool kExplain>
inline void add_rows(std::span<LimitRow> rows, std::size_t jerk_rows, const LimitWindow& x,
                     double root, double primal, double dual, LimitSums& sums, LimitTally& tally) {
  TangentSums of_jerk;
  LimitSides jerk_room = LimitSides::Constant(root);
  LimitSides room = LimitSides::Ones();
  for (LimitRow& row : rows.first(jerk_rows)) {
    add_row<true, kExplain>(row, x, root, primal, dual, sums, of_jerk, jerk_room, tally);
  }
  for (LimitRow& row : rows.subspan(jerk_rows)) {
    add_row<false, kExplain>(row, x, 1, primal, dual, sums, of_jerk, room, tally);
  }
  const double jerk_excess = -std::min(jerk_room[0], jerk_room[1]) * (x[0] * root);
  tally.excess = std::max({tally.excess, -std::min(room[0], room[1]), jerk_excess});
  const double tangent = 0.5 * root * root * root;  // 1 / sqrt(q) falls by that per q
  const LimitWindow& mixed = of_jerk.mixed;
  sums.square[0] += tangent * (tangent * of_jerk.square.sum() + 2 * mixed[0]);
  sums.square[1] += tangent * mixed[1];
  sums.square[3] += tangent * mixed[2];
  sums.base[0] += tangent * of_jerk.base.sum();
  sums.center[0] -= tangent * of_jerk.center.sum();
  sums.unexplained[0] += tangent * of_jerk.dual.sum();
}

// The steps of slacks and duals that belong to the change of (q, p, r).
inline void step_rows(std::span<LimitRow> rows, std::size_t jerk_rows, const LimitWindow& change,
                      double root, double target, LimitReach& reach) {
  const double right = -0.5 * root * root * root * change[0];
  for (std::size_t i = 0; i < rows.size(); ++i) {
    LimitRow& row = rows[i];
    const double left = dot(row.c, change);
    const double moved = i < jerk_rows ? right : 0;
    row.slack_step = row.missing + LimitSides(moved - left, moved + left);
    row.dual_step = (target - row.dual * row.slack_step) * row.inverse - row.dual;
    reach.slack = reach.slack.max(-row.slack_step * row.inverse);
    reach.dual = reach.dual.max(-row.dual_step / row.dual);
  }
}

inline void add_bound(LimitBound& bound, double q, double primal, double dual, LimitSums& sums,
                      LimitTally& tally) {
  if (!bound.is_there()) return;
  bound.slack += primal * bound.slack_step;
  bound.dual += dual * bound.dual_step;
  const double c = bound.scale;
  bound.missing = 1 - c * q - bound.slack;
  bound.inverse = 1 / bound.slack;
  tally.gap[0] += bound.slack * bound.dual;
  tally.excess = std::max(tally.excess, c * q - 1);
  const double weight = bound.dual * bound.inverse;
  sums.square[0] += weight * c * c;
  sums.base[0] += c * weight * bound.missing;
  sums.center[0] -= c * bound.inverse;
  sums.unexplained[0] += c * bound.dual;
}

inline void step_bound(LimitBound& bound, double dq, double target, LimitReach& reach) {
  if (!bound.is_there()) return;
  bound.slack_step = bound.missing - dq * bound.scale;
  bound.dual_step = (target - bound.dual * bound.slack_step) * bound.inverse - bound.dual;
  reach.primal = std::max(reach.primal, -bound.slack_step * bound.inverse);
  reach.dual[0] = std::max(reach.dual[0], -bound.dual_step / bound.dual);
}

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
