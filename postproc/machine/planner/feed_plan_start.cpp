// Where the search for a feed plan starts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/machine/planner/feed_plan_problem.h"

namespace batten::postproc {
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
double monotone_slope(double before, double after) {
  return before * after > 0 ? 2 * before * after / (before + after) : 0;
}

std::vector<double> unknowns_of(const PlanProblem& problem, const std::vector<double>& q) {
  const std::size_t n = problem.intervals();
  const auto rise = [&](std::size_t i) { return (q[i + 1] - q[i]) / problem.lengths[i]; };
  std::vector<double> x(problem.unknowns());
  for (std::size_t i = 0; i <= n; ++i) {
    x[2 * i] = q[i];
    x[2 * i + 1] = i > 0 && i < n ? monotone_slope(rise(i - 1), rise(i)) : 0;
  }
  // At ends that are not at rest without acceleration: given so, or a start as good as any.
  x[1] = problem.start.slope() * x[0];
  x[2 * n + 1] = -problem.end.slope() * x[2 * n];
  return x;
}

// The greatest factor on all unknowns that keeps the limits, at most 1.
double allowed_factor(const PlanProblem& problem, const std::vector<double>& x) {
  double factor = 1;
  for (std::size_t i = 0; i < problem.intervals(); ++i) {
    const auto states = states_at_places(x.data() + 2 * i, problem.lengths[i]);
    for (std::size_t p = 0; p < kPlanPlaces; ++p) {
      const PlanPlace& place = problem.places[kPlanPlaces * i + p];
      const LimitWindow state = {states[p].q, states[p].p, states[p].r};
      factor = std::min(factor, place.most / state[0]);
      for (std::size_t k = 0; k < place.rows; ++k) {
        const double size = std::abs(dot(problem.rows[place.first_row + k], state));
        if (!(size > 0)) continue;
        if (k < place.jerk_rows) {
          const double ratio = 1 / (std::sqrt(state[0]) * size);
          factor = std::min(factor, std::cbrt(ratio * ratio));
        } else {
          factor = std::min(factor, 1 / size);
        }
      }
    }
  }
  return factor;
}

}  // namespace

void slow_down(const PlanProblem& problem, std::vector<double>& x) {
  const double factor = allowed_factor(problem, x);
  const std::size_t first = problem.start_is_given ? 2 : 0;
  const std::size_t last = x.size() - (problem.end_is_given ? 2 : 0);
  for (std::size_t i = first; i < last; ++i) x[i] *= factor;
}

bool raise_above_zero(const PlanProblem& problem, std::vector<double>& x) {
  const std::size_t n = problem.intervals();
  const auto rise = [&](std::size_t i) { return (x[2 * i + 2] - x[2 * i]) / problem.lengths[i]; };
  const auto is_above = [&](std::size_t i) {
    const auto states = states_at_places(x.data() + 2 * i, problem.lengths[i]);
    return std::ranges::all_of(states, [](const PlanState& state) { return state.q > 0; });
  };
  const auto flatten = [&](std::size_t node) {
    if (node > 0 && node < n) x[2 * node + 1] = monotone_slope(rise(node - 1), rise(node));
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
  const std::size_t first = problem.start.length > 0 ? 1 : 0;
  std::vector<double> logarithms;
  for (std::size_t i = 0; i <= problem.intervals(); ++i) {
    logarithms.push_back(2 * std::log(grid.speeds[first + i]));
  }
  constexpr int kPasses = 12;  // about two changes of the speed, at the usual density
  smooth(logarithms, kPasses);
  std::vector<double> q;
  q.reserve(logarithms.size());
  for (const double value : logarithms) q.push_back(std::exp(value));
  std::vector<double> x = unknowns_of(problem, q);
  if (problem.start_is_given) x[0] = grid.bounds.front() * grid.bounds.front();
  if (problem.end_is_given) x[x.size() - 2] = grid.bounds.back() * grid.bounds.back();
  return x;
}

}  // namespace batten::postproc
