#include "postproc/machine/planner/feed_plan_problem.h"

#include <algorithm>
#include <cmath>

#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

constexpr double kNone = KinematicPathLimits::kNone;

// The limits at one place after the other.
class RowMaker {
 public:
  RowMaker(const KinematicPathLimits& limits, PlanProblem& problem)
      : limits_(limits), problem_(problem) {}

  // The jerk is asked for at both sides of a node, the rest at one.
  void add_place(const LengthDerivatives& x, bool with_acceleration) {
    PlanPlace place;
    place.first_row = problem_.rows.size();
    add_jerk(x);
    place.jerk_rows = problem_.rows.size() - place.first_row;
    if (with_acceleration) {
      add_acceleration(x);
      const double speed = limits_along(x.first, limits_).speed;
      const double curvature = x.second.norm();
      place.most = speed * speed;
      if (curvature > 0) place.most = std::min(place.most, limits_.normal_acceleration / curvature);
    }
    place.rows = problem_.rows.size() - place.first_row;
    problem_.places.push_back(place);
  }

 private:
  void add_acceleration(const LengthDerivatives& x) {
    if (straight(x)) return row(0, 0.5, 0, limits_along(x.first, limits_).acceleration);
    for (int i = 0; i < 3; ++i) row(x.second[i], 0.5 * x.first[i], 0, limits_.acceleration[i]);
    row(0, 0.5, 0, limits_.tangential_acceleration);
  }

  void add_jerk(const LengthDerivatives& x) {
    if (straight(x)) return row(0, 0, 0.5, limits_along(x.first, limits_).jerk);
    for (int i = 0; i < 3; ++i) {
      row(x.third[i], 1.5 * x.second[i], 0.5 * x.first[i], limits_.jerk[i]);
    }
    row(0, 0, 0.5, limits_.tangential_jerk);
  }

  static bool straight(const LengthDerivatives& x) {
    return x.second == Vector3::Zero() && x.third == Vector3::Zero();
  }

  void row(double q, double p, double r, double limit) {
    if (std::isinf(limit) || (q == 0 && p == 0 && r == 0)) return;
    problem_.rows.push_back({q / limit, p / limit, r / limit});
  }

  const KinematicPathLimits& limits_;
  PlanProblem& problem_;
};

void lower(double& most, double speed) { most = std::min(most, speed * speed); }

// The speed, one interval away from rest, at which the interval from rest keeps the jerk: its
// terms, each at the greater end, all of one sign.
double speed_after_rest(const PathPiece& piece, const GridInterval& interval, const PlanRest& rest,
                        const KinematicPathLimits& limits) {
  const LengthDerivatives a = derivatives_by_length(piece, interval.t0);
  const LengthDerivatives b = derivatives_by_length(piece, interval.t1);
  const double power = 2 * rest.power;
  const double by_p = 1.5 * power / rest.length;
  const double by_r = 0.5 * power * (power - 1) / (rest.length * rest.length);
  const auto greater = [](const Vector3& x, const Vector3& y) {
    return Vector3(x.cwiseAbs().cwiseMax(y.cwiseAbs()));
  };
  const Vector3 jerk = greater(a.third, b.third) + by_p * greater(a.second, b.second) +
                       by_r * greater(a.first, b.first);
  double cubed = by_r > 0 ? limits.tangential_jerk / by_r : kNone;
  for (int i = 0; i < 3; ++i) {
    if (jerk[i] > 0) cubed = std::min(cubed, limits.jerk[i] / jerk[i]);
  }
  return std::cbrt(cubed);
}

bool jerk_is_limited(const KinematicPathLimits& limits) {
  return !std::isinf(std::min(limits.jerk.minCoeff(), limits.tangential_jerk));
}

}  // namespace

std::array<PlanState, kPlanPlaces> states_at_places(const double* w, double length) {
  const double rise = (w[2] - w[0]) / length;
  const double turn = (w[3] - w[1]) / length;
  const double k = 6 * rise;
  return {PlanState{w[0], w[1], (k - 4 * w[1] - 2 * w[3]) / length},
          PlanState{0.5 * (w[0] + w[2]) - length * length / 8 * turn,
                    1.5 * rise - 0.25 * (w[1] + w[3]), turn},
          PlanState{w[2], w[3], (2 * w[1] + 4 * w[3] - k) / length}};
}

PlanProblem make_plan_problem(std::span<const PathPiece> pieces, const PlanGrid& grid,
                              const KinematicPathLimits& limits) {
  PlanProblem problem;
  const bool from_rest = grid.bounds.front() == 0;
  const bool to_rest = grid.bounds.back() == 0;
  const double power = jerk_is_limited(limits) ? 2.0 / 3 : 0.5;
  const std::size_t first = from_rest ? 1 : 0;
  const std::size_t last = grid.intervals.size() - (to_rest ? 1 : 0);
  if (from_rest) problem.start = {grid.intervals.front().length, power};
  if (to_rest) problem.end = {grid.intervals.back().length, power};

  RowMaker maker(limits, problem);
  for (std::size_t k = first; k < last; ++k) {
    const GridInterval& interval = grid.intervals[k];
    const PathPiece& piece = pieces[interval.piece];
    problem.lengths.push_back(interval.length);
    // Speed and acceleration run on from the end of the interval before, unless the bend jumps.
    const bool new_piece = k == first || grid.intervals[k - 1].piece != interval.piece;
    maker.add_place(derivatives_by_length(piece, interval.t0), new_piece);
    if (grid.bounds[k] > 0) lower(problem.places.back().most, grid.bounds[k]);
    maker.add_place(derivatives_by_length(piece, middle_of(piece, interval)), true);
    maker.add_place(derivatives_by_length(piece, interval.t1), true);
  }
  const auto rest_speed = [&](const GridInterval& interval, const PlanRest& rest) {
    return speed_after_rest(pieces[interval.piece], interval, rest, limits);
  };
  double& start_most = problem.places.front().most;
  double& end_most = problem.places.back().most;
  if (from_rest) lower(start_most, rest_speed(grid.intervals.front(), problem.start));
  lower(end_most, to_rest ? rest_speed(grid.intervals.back(), problem.end) : grid.bounds.back());
  problem.start_is_given = grid.slow_start;
  problem.end_is_given = grid.slow_end;
  if (grid.slow_start) start_most = kNone;
  if (grid.slow_end) end_most = kNone;
  return problem;
}

PlanState state_in(const double* w, double length, double s) {
  const double rise = (w[2] - w[0]) / length;
  const double r0 = (6 * rise - 4 * w[1] - 2 * w[3]) / length;
  const double third = 6 * (w[1] + w[3] - 2 * rise) / (length * length);
  return {w[0] + s * (w[1] + s * (r0 / 2 + s * third / 6)), w[1] + s * (r0 + s * third / 2),
          r0 + s * third};
}

// One Newton step from the middle by parameter.
double middle_of(const PathPiece& piece, const GridInterval& interval) {
  const double t = 0.5 * (interval.t0 + interval.t1);
  const double missing = 0.5 * interval.length - length_between(piece, interval.t0, t);
  const double rate = length_between(piece, interval.t0, interval.t1) / (interval.t1 - interval.t0);
  const double quarter = 0.25 * (interval.t1 - interval.t0);
  return t + std::clamp(missing / rate, -quarter, quarter);
}

double interval_seconds(double length, const double* w) {
  const double middle = 0.5 * (w[0] + w[2]) + length / 8 * (w[1] - w[3]);
  return length / 6 * (1 / std::sqrt(w[0]) + 4 / std::sqrt(middle) + 1 / std::sqrt(w[2]));
}

double planned_seconds(const PlanProblem& problem, std::span<const double> x) {
  const std::size_t n = problem.intervals();
  double time = problem.start.time() / std::sqrt(x[0]) + problem.end.time() / std::sqrt(x[2 * n]);
  for (std::size_t i = 0; i < n; ++i) {
    time += interval_seconds(problem.lengths[i], x.data() + 2 * i);
  }
  return time;
}

}  // namespace batten::postproc
