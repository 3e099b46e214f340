// The fastest unknowns of a feed plan.
#pragma once

#include <vector>

#include "postproc/machine/planner/feed_plan_problem.h"

namespace batten::postproc {

struct PlanSolution {
  std::vector<double> x;  // keeps every row of the problem, to 1e-4 of its limit
  double seconds = 0;
  double gap = 0;  // seconds: what the convex problem at x could still gain, as its duals say
  int iterations = 0;
};

struct SearchRule {
  double first_gap = 0.5;    // products of limits and duals at the start, as part of the time
  double enough_gap = 2e-5;  // the search ends where the duals promise no more than this part
  double least_slack = 0.2;  // at the start, as part of the limit: more for a rough start
};

// A primal-dual interior-point method from any unknowns, also such that exceed limits. The rows are
// those of feed_plan_rows.h. Each step is one symmetric system with three sub-diagonals: linear
// cost. What does not come to keep its limits is slowed down as a whole until it does.
[[nodiscard]] PlanSolution fastest_plan(const PlanProblem& problem, std::vector<double> start,
                                        const SearchRule& rule = {});

}  // namespace batten::postproc
