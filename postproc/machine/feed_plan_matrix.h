// The linear system of one step of the search for a feed plan: symmetric, three sub-diagonals, with
// the ends at rest folded in.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "postproc/machine/feed_plan_problem.h"

namespace batten::postproc {

// A symmetric 4 x 4 block. Its loops are written out: they are what the search spends its time in.
struct PlanBlock {
  std::array<double, 10> lower{};  // row by row

  // Adds w c c^T.
  void add_square(double w, const PlanWindow& c) {
    const PlanWindow s = {w * c[0], w * c[1], w * c[2], w * c[3]};
    add_half_product(s, c);
  }

  // Adds s c^T + c s^T.
  void add_product(const PlanWindow& s, const PlanWindow& c) {
    add_half_product(s, c);
    add_half_product(c, s);
  }

 private:
  // The lower half of s c^T.
  void add_half_product(const PlanWindow& s, const PlanWindow& c) {
    lower[0] += s[0] * c[0];
    lower[1] += s[1] * c[0];
    lower[2] += s[1] * c[1];
    lower[3] += s[2] * c[0];
    lower[4] += s[2] * c[1];
    lower[5] += s[2] * c[2];
    lower[6] += s[3] * c[0];
    lower[7] += s[3] * c[1];
    lower[8] += s[3] * c[2];
    lower[9] += s[3] * c[3];
  }
};

// Adds w c.
inline void add_scaled(PlanWindow& sum, double w, const PlanWindow& c) {
  sum[0] += w * c[0];
  sum[1] += w * c[1];
  sum[2] += w * c[2];
  sum[3] += w * c[3];
}

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

  // At an end at rest, p is a multiple of q: its row and column join those of q.
  void fold_ends();

  double start_slope_;  // p / q at an end at rest, else 0
  double end_slope_;
  std::vector<std::array<double, kBands + 1>> rows_;  // diagonal first, then to the left of it
};

}  // namespace batten::postproc
