#include "postproc/machine/planner/feed_plan_problem.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

constexpr double kNone = KinematicPathLimits::kNone;

// Start, middle and end of each interval.
constexpr std::size_t kPlaces = 3;

// The place of number `which` of an interval that is h mm long.
SearchPlace place_of(std::size_t interval, std::size_t which, double h) {
  const double k = 6 / (h * h);
  SearchPlace place;
  place.first = 2 * interval;
  place.width = 4;
  if (which == 0) {
    place.q = {1, 0, 0, 0};
    place.p = {0, 1, 0, 0};
    place.r = {-k, -4 / h, k, -2 / h};
  } else if (which == 1) {
    place.q = {0.5, h / 8, 0.5, -h / 8};
    place.p = {-1.5 / h, -0.25, 1.5 / h, -0.25};
    place.r = {0, -1 / h, 0, 1 / h};
  } else {
    place.q = {0, 0, 1, 0};
    place.p = {0, 0, 0, 1};
    place.r = {k, 2 / h, -k, 4 / h};
  }
  place.time = which == 1 ? 4 * h / 6 : h / 6;  // Simpson's rule
  return place;
}

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

void add_interval(const PathPiece& piece, const GridInterval& interval, bool new_piece,
                  const KinematicPathLimits& limits, PlanProblem& problem) {
  const std::size_t number = problem.lengths.size();
  problem.lengths.push_back(interval.length);
  for (std::size_t which = 0; which < kPlaces; ++which) {
    SearchPlace place = place_of(number, which, interval.length);
    const double t = which == 0   ? interval.t0
                     : which == 1 ? middle_of(piece, interval)
                                  : interval.t1;
    const LengthDerivatives x = derivatives_by_length(piece, t);
    problem.search.add_jerk_rows(x, limits, place);
    // Speed and acceleration run on from the end of the interval before, unless the bend jumps.
    if (which > 0 || new_piece) problem.search.add_other_limits(x, limits, kNone, place);
    problem.search.places.push_back(place);
  }
}

}  // namespace

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

  SearchProblem& search = problem.search;
  for (std::size_t k = first; k < last; ++k) {
    const GridInterval& interval = grid.intervals[k];
    const bool new_piece = k == first || grid.intervals[k - 1].piece != interval.piece;
    add_interval(pieces[interval.piece], interval, new_piece, limits, problem);
    double& most = search.places[search.places.size() - kPlaces].most;
    if (grid.bounds[k] > 0) lower(most, grid.bounds[k]);
  }
  search.unknowns = 2 * problem.intervals() + 2;
  const auto rest_speed = [&](const GridInterval& interval, const PlanRest& rest) {
    return speed_after_rest(pieces[interval.piece], interval, rest, limits);
  };
  // One end: its place, its node's q and what holds between that and p.
  const auto set_end = [&](bool rests, bool is_given, const PlanRest& rest, double bound,
                           const GridInterval& outer, double sign, SearchPlace& place,
                           std::size_t q) {
    place.time += rest.time();
    if (rests) {
      lower(place.most, rest_speed(outer, rest));
      search.ties.push_back({q + 1, q, sign * rest.slope(), 0});
    } else if (is_given) {
      place.most = kNone;
      search.pins.push_back({q, bound * bound});
      search.pins.push_back({q + 1, 0});
    } else {
      lower(place.most, bound);
    }
  };
  set_end(from_rest, grid.slow_start, problem.start, grid.bounds.front(), grid.intervals.front(), 1,
          search.places.front(), 0);
  set_end(to_rest, grid.slow_end, problem.end, grid.bounds.back(), grid.intervals.back(), -1,
          search.places.back(), search.unknowns - 2);
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

namespace {

// One pass takes the mean of each inner value and its neighbours. Nodes are spread by the time
// that the machine needs for a change, so this rounds off corners of the envelope, as limited jerk
// does, on each scale alike.
void smooth(std::vector<double>& values, int passes) {
  for (int pass = 0; pass < passes; ++pass) {
    double before = values.front();
    for (std::size_t i = 1; i + 1 < values.size(); ++i) {
      const double here = values[i];
      values[i] = 0.25 * before + 0.5 * here + 0.25 * values[i + 1];
      before = here;
    }
  }
}

// The slope at a node between two intervals that keeps a cubic monotone where the values are:
// their harmonic mean, or 0 at an extremum.
double monotone_slope(const PlanProblem& problem, const std::vector<double>& x, std::size_t node) {
  const auto rise = [&](std::size_t i) { return (x[2 * i + 2] - x[2 * i]) / problem.lengths[i]; };
  const double before = rise(node - 1);
  const double after = rise(node);
  return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

}  // namespace

bool raise_above_zero(const PlanProblem& problem, std::vector<double>& x) {
  const std::size_t n = problem.intervals();
  const auto is_above = [&](std::size_t i) {
    const double* w = x.data() + 2 * i;
    return w[0] > 0 && w[2] > 0 && state_in(w, problem.lengths[i], 0.5 * problem.lengths[i]).q > 0;
  };
  const auto flatten = [&](std::size_t node) {
    if (node > 0 && node < n) x[2 * node + 1] = monotone_slope(problem, x, node);
  };
  // Flatter slopes may take the neighbours below 0, which are flattened in the next pass.
  constexpr int kPasses = 4;
  for (int pass = 0; pass < kPasses; ++pass) {
    bool above = true;
    for (std::size_t i = 0; i < n; ++i) {
      if (is_above(i)) continue;
      above = false;
      flatten(i);
      flatten(i + 1);
    }
    if (above) return true;
  }
  return false;
}

std::vector<double> rough_start(const PlanProblem& problem, const PlanGrid& grid) {
  const std::size_t n = problem.intervals();
  const std::size_t first = problem.start.length > 0 ? 1 : 0;
  std::vector<double> logarithms;
  for (std::size_t i = 0; i <= n; ++i) {
    logarithms.push_back(2 * std::log(grid.speeds[first + i]));
  }
  constexpr int kPasses = 12;  // about two changes of the speed, at the usual density
  smooth(logarithms, kPasses);
  std::vector<double> x(problem.search.unknowns);
  for (std::size_t i = 0; i <= n; ++i) x[2 * i] = std::exp(logarithms[i]);
  for (std::size_t i = 1; i < n; ++i) x[2 * i + 1] = monotone_slope(problem, x, i);
  // At ends that are not at rest without acceleration: given so, or a start as good as any.
  for (const UnknownTie& tie : problem.search.ties) x[tie.tied] = tie.factor * x[tie.free];
  for (const UnknownPin& pin : problem.search.pins) x[pin.unknown] = pin.value;
  return x;
}

}  // namespace batten::postproc
