// The fastest unknowns of a feed plan.
#pragma once

#include <array>
#include <cstddef>
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

// The linear system of one step of the search for a feed plan: symmetric, three sub-diagonals, with
// the ends at rest folded in.

// A symmetric 4 x 4 block.
struct PlanBlock {
  std::array<double, 10> lower{};  // row by row
};

class PlanMatrix {
 public:
  explicit PlanMatrix(const PlanProblem& problem);

  void set_zero();

  // Adds the second derivatives by the window of one interval.
  void add(std::size_t interval, const PlanBlock& block);

  // Overwrites the matrix by its factors L D L^T. False when a pivot is not positive.
  [[nodiscard]] bool factor();

  // After factor(): solves in place.
  void solve(std::vector<double>& right) const;

 private:
  static constexpr int kBands = 3;

  // At an end at rest, p is a multiple of q: its row and column join those of q. At an end that is
  // given, neither changes.
  void fold_ends();

  double start_slope_;  // p / q at an end at rest, else 0
  double end_slope_;
  bool start_is_given_;
  bool end_is_given_;
  std::vector<std::array<double, kBands + 1>> rows_;  // diagonal first, then to the left of it
};

}  // namespace batten::postproc
