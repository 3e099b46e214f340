#include "postproc/machine/planner/feed_plan_matrix.h"

#include <algorithm>

namespace batten::postproc {

PlanMatrix::PlanMatrix(const PlanProblem& problem)
    : start_slope_(problem.start.slope()),
      end_slope_(-problem.end.slope()),
      start_is_given_(problem.start_is_given),
      end_is_given_(problem.end_is_given),
      rows_(problem.unknowns()) {}

void PlanMatrix::set_zero() { std::fill(rows_.begin(), rows_.end(), rows_[0] = {}); }

void PlanMatrix::add(std::size_t interval, const PlanBlock& block) {
  int entry = 0;
  for (int a = 0; a < 4; ++a) {
    auto& row = rows_[2 * interval + a];
    for (int b = 0; b <= a; ++b) row[a - b] += block.lower[entry++];
  }
}

void PlanMatrix::fold_ends() {
  if (start_is_given_) {
    rows_[0] = rows_[1] = {1, 0, 0, 0};
    rows_[2][1] = rows_[2][2] = rows_[3][2] = rows_[3][3] = 0;
  }
  if (end_is_given_) rows_[rows_.size() - 1] = rows_[rows_.size() - 2] = {1, 0, 0, 0};
  if (start_slope_ != 0) {
    const double k = start_slope_;
    rows_[0][0] += 2 * k * rows_[1][1] + k * k * rows_[1][0];
    rows_[2][2] += k * rows_[2][1];
    rows_[3][3] += k * rows_[3][2];
    rows_[1] = {1, 0, 0, 0};
    rows_[2][1] = rows_[3][2] = 0;
  }
  if (end_slope_ != 0) {
    const double k = end_slope_;
    auto& p = rows_[rows_.size() - 1];
    auto& q = rows_[rows_.size() - 2];
    q[0] += 2 * k * p[1] + k * k * p[0];
    q[1] += k * p[2];
    q[2] += k * p[3];
    p = {1, 0, 0, 0};
  }
}

bool PlanMatrix::factor() {
  fold_ends();
  // Row by row; rows_[i][k] becomes L(i, i - k), and rows_[i][0] the inverse of D(i).
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    auto& row = rows_[i];
    const int before = static_cast<int>(std::min<std::size_t>(i, kBands));
    double diagonal = row[0];
    for (int k = before; k >= 1; --k) {
      // row[k] holds L(i, i - k) D(i - k) of the entries further left.
      for (int m = k + 1; m <= before; ++m) row[k] -= row[m] * rows_[i - k][m - k];
    }
    for (int k = 1; k <= before; ++k) {
      const double scaled = row[k] * rows_[i - k][0];
      diagonal -= scaled * row[k];
      row[k] = scaled;
    }
    if (!(diagonal > 0)) return false;
    row[0] = 1 / diagonal;
  }
  return true;
}

void PlanMatrix::solve(std::vector<double>& right) const {
  const std::size_t n = rows_.size();
  if (start_is_given_) right[0] = right[1] = 0;
  if (end_is_given_) right[n - 1] = right[n - 2] = 0;
  if (start_slope_ != 0) {
    right[0] += start_slope_ * right[1];
    right[1] = 0;
  }
  if (end_slope_ != 0) {
    right[n - 2] += end_slope_ * right[n - 1];
    right[n - 1] = 0;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const int before = static_cast<int>(std::min<std::size_t>(i, kBands));
    for (int k = 1; k <= before; ++k) right[i] -= rows_[i][k] * right[i - k];
  }
  for (std::size_t i = n; i-- > 0;) {
    right[i] *= rows_[i][0];
    for (int k = 1; k <= kBands && i + k < n; ++k) right[i] -= rows_[i + k][k] * right[i + k];
  }
  if (start_slope_ != 0) right[1] = start_slope_ * right[0];
  if (end_slope_ != 0) right[n - 1] = end_slope_ * right[n - 2];
}

}  // namespace batten::postproc
