// The linear system of one step of the search for a feed plan: symmetric, three sub-diagonals, with
// the ends at rest folded in.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "postproc/machine/planner/feed_plan_problem.h"

namespace batten::postproc {

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
