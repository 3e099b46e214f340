// The fastest unknowns of a feed plan.
#pragma once

#include <vector>

#include "postproc/machine/feed_plan_problem.h"

namespace batten::postproc {

struct PlanSolution {
  std::vector<double> x;  // keeps every row of the problem
  double seconds = 0;
  double gap = 0;  // seconds: what the convex problem at x could still gain, as its duals say
  int iterations = 0;
};

// A primal-dual interior-point method (S. Mehrotra 1992) from unknowns that keep all limits with
// some margin. The jerk limit |c.x| <= 1 / sqrt(q) is not convex: its right side is replaced by its
// tangent at the present q, which is below it everywhere (1 / sqrt is convex), anew in every step;
// so every iterate keeps every limit. Each step is one symmetric system with three sub-diagonals:
// linear cost.
struct SearchRule {
  double first_gap = 0.5;    // products of limits and duals at the start, as part of the time
  double enough_gap = 2e-5;  // the search ends where the duals promise no more than this part
};

[[nodiscard]] PlanSolution fastest_plan(const PlanProblem& problem, std::vector<double> start,
                                        const SearchRule& rule = {});

}  // namespace batten::postproc
