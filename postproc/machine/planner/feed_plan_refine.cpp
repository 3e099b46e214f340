#include "postproc/machine/planner/feed_plan_refine.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

double greatest_part(const Vector3& value, const Vector3& limit) {
  return value.cwiseAbs().cwiseQuotient(limit).maxCoeff();
}

// The greatest part of any limit that a state uses.
double use_of_limits(const LengthDerivatives& x, const PlanState& at,
                     const KinematicPathLimits& limits) {
  const double v = std::sqrt(at.q);
  const Vector3 acceleration = x.second * at.q + x.first * (at.p / 2);
  const Vector3 jerk = (x.third * at.q + x.second * (1.5 * at.p) + x.first * (0.5 * at.r)) * v;
  return std::max({v / limits.feed, greatest_part(x.first * v, limits.speed),
                   x.second.norm() * at.q / limits.normal_acceleration,
                   greatest_part(acceleration, limits.acceleration),
                   greatest_part(jerk, limits.jerk),
                   0.5 * std::abs(at.p) / limits.tangential_acceleration,
                   0.5 * std::abs(at.r) * v / limits.tangential_jerk});
}

// How much of its limit the jerk along the path changes by, or the acceleration where the
// jerk has no limit.
double change_along(const LengthDerivatives& x, const PlanState& from, const PlanState& to,
                    const KinematicPathLimits& limits) {
  const LimitsAlong along = limits_along(x.first, limits);
  if (std::isinf(along.jerk)) return 0.5 * std::abs(to.p - from.p) / along.acceleration;
  return 0.5 * std::abs(to.r * std::sqrt(to.q) - from.r * std::sqrt(from.q)) / along.jerk;
}

bool is_too_long(const PathPiece& piece, const GridInterval& interval, const double* window,
                 const KinematicPathLimits& limits, const RefineRule& rule) {
  const double h = interval.length;
  const LengthDerivatives middle = derivatives_by_length(piece, 0.5 * (interval.t0 + interval.t1));
  const PlanState from = state_in(window, h, 0);
  const PlanState to = state_in(window, h, h);
  if (change_along(middle, from, to, limits) > rule.switching) return true;
  // The limits are kept at both ends and in the middle: look between those.
  for (const double part : {0.125, 0.25, 0.375, 0.625, 0.75, 0.875}) {
    const double t = interval.t0 + part * (interval.t1 - interval.t0);
    const double s = length_between(piece, interval.t0, t);
    const LengthDerivatives x = derivatives_by_length(piece, t);
    if (use_of_limits(x, state_in(window, h, s), limits) > 1 + rule.excess) return true;
  }
  return false;
}

}  // namespace

std::size_t refine_plan(std::span<const PathPiece> pieces, const KinematicPathLimits& limits,
                        const PlanProblem& problem, const RefineRule& rule, PlanGrid& grid,
                        std::vector<double>& x) {
  const std::size_t first = problem.start.length > 0 ? 1 : 0;
  const std::size_t end = first + problem.intervals();
  PlanGrid finer;
  std::vector<double> finer_x = {x[0], x[1]};
  std::size_t cut = 0;
  for (std::size_t k = 0; k < grid.intervals.size(); ++k) {
    const GridInterval& interval = grid.intervals[k];
    finer.bounds.push_back(grid.bounds[k]);
    finer.speeds.push_back(grid.speeds[k]);
    if (k < first || k >= end) {
      finer.intervals.push_back(interval);
      continue;
    }
    const PathPiece& piece = pieces[interval.piece];
    const double* window = x.data() + 2 * (k - first);
    if (is_too_long(piece, interval, window, limits, rule)) {
      ++cut;
      const double t = middle_of(piece, interval);
      const double length = length_between(piece, interval.t0, t);
      const PlanState middle = state_in(window, interval.length, length);
      finer.intervals.push_back({interval.piece, interval.t0, t, length});
      finer.intervals.push_back({interval.piece, t, interval.t1, interval.length - length});
      finer.bounds.push_back(KinematicPathLimits::kNone);
      finer.speeds.push_back(std::sqrt(middle.q));
      finer_x.insert(finer_x.end(), {middle.q, middle.p});
    } else {
      finer.intervals.push_back(interval);
    }
    finer_x.insert(finer_x.end(), {window[2], window[3]});
  }
  finer.slow_start = grid.slow_start;
  finer.slow_end = grid.slow_end;
  finer.bounds.push_back(grid.bounds.back());
  finer.speeds.push_back(grid.speeds.back());
  grid = std::move(finer);
  x = std::move(finer_x);
  return cut;
}

}  // namespace batten::postproc
