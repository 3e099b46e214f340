// Where the search for a feed plan starts.
#include <algorithm>
#include <cmath>
#include <limits>

#include "postproc/machine/feed_plan_problem.h"

namespace batten::postproc {
namespace {

// Of the greatest speed squared: the interior-point search must start inside of all limits.
constexpr double kStartMargin = 0.9;

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
  x[1] = problem.start.slope() * x[0];
  x[2 * n + 1] = -problem.end.slope() * x[2 * n];
  return x;
}

// The greatest factor on all unknowns that keeps the limits.
double allowed_factor(const PlanProblem& problem, const std::vector<double>& x) {
  double factor = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < problem.intervals(); ++i) {
    for (const PlanRow& row : problem.rows_of(i)) {
      const double* w = x.data() + 2 * i;
      const double size = std::abs(dot(row.c, w));
      if (!(size > 0)) continue;
      if (row.limit == PlanLimit::kJerk) {
        const double q = dot(plan_weights(row.place, problem.lengths[i]).q, w);
        const double ratio = 1 / (std::sqrt(q) * size);
        factor = std::min(factor, std::cbrt(ratio * ratio));
      } else {
        factor = std::min(factor, 1 / size);
      }
    }
  }
  return factor;
}

}  // namespace

void slow_down(const PlanProblem& problem, double part, std::vector<double>& x) {
  const double factor = part * allowed_factor(problem, x);
  for (double& value : x) value *= factor;
}

std::vector<double> feasible_start(const PlanProblem& problem, const PlanGrid& grid) {
  const std::size_t first = problem.start.length > 0 ? 1 : 0;
  std::vector<double> logarithms;
  for (std::size_t i = 0; i <= problem.intervals(); ++i) {
    logarithms.push_back(2 * std::log(grid.speeds[first + i]));
  }
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (const int passes : {4, 12, 48, 192}) {
    smooth(logarithms, passes);
    std::vector<double> q;
    q.reserve(logarithms.size());
    for (const double value : logarithms) q.push_back(std::exp(value));
    std::vector<double> x = unknowns_of(problem, q);
    slow_down(problem, kStartMargin, x);
    const double time = planned_seconds(problem, x);
    if (time < least) {
      least = time;
      best = std::move(x);
    }
  }
  return best;
}

}  // namespace batten::postproc
