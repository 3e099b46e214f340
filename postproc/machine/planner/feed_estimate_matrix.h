// The linear system of one step of the quick estimate's search.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace batten::postproc {

// Symmetric, two sub-diagonals, positive. At least two rows.
class EstimateMatrix {
 public:
  explicit EstimateMatrix(std::size_t size) : rows_(size) {}

  void set_zero() { std::fill(rows_.begin(), rows_.end(), Row{}); }
  // The entry (row, row - left).
  double& at(std::size_t row, int left) { return rows_[row][left]; }

  // Overwrites the matrix by its factors L D L^T.
  void factor() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      Row& row = rows_[i];
      double diagonal = row[0];
      if (i > 1) {
        const double far = row[2];
        row[1] -= far * rows_[i - 1][1];
        row[2] = far * rows_[i - 2][0];
        diagonal -= far * row[2];
      }
      if (i > 0) {
        const double near = row[1];
        row[1] = near * rows_[i - 1][0];
        diagonal -= near * row[1];
      }
      row[0] = 1 / std::max(diagonal, 1e-300);
    }
  }

  // After factor(), in place.
  void solve(std::vector<double>& x) const {
    const std::size_t n = rows_.size();
    x[1] -= rows_[1][1] * x[0];
    for (std::size_t i = 2; i < n; ++i) x[i] -= rows_[i][1] * x[i - 1] + rows_[i][2] * x[i - 2];
    for (std::size_t i = 0; i < n; ++i) x[i] *= rows_[i][0];
    x[n - 2] -= rows_[n - 1][1] * x[n - 1];
    for (std::size_t i = n - 2; i-- > 0;) {
      x[i] -= rows_[i + 1][1] * x[i + 1] + rows_[i + 2][2] * x[i + 2];
    }
  }

 private:
  // The diagonal (after factor() its inverse), then to the left of it.
  using Row = std::array<double, 3>;

  std::vector<Row> rows_;
};

}  // namespace batten::postproc
