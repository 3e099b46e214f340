// Symmetric positive definite systems whose unknowns are the control points of a cubic B-spline,
// with the axes coupled: blocks of 3 x 3, three of them below the diagonal. Factored and solved
// in linear time.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

class BlockBandedMatrix {
 public:
  static constexpr std::size_t kBands = 3;  // blocks below the diagonal

  explicit BlockBandedMatrix(std::size_t size) : rows_(size) { set_zero(); }

  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  void set_zero();

  // Block (i, i - below), below <= kBands, below <= i. Only the lower half is kept; a diagonal
  // block is given whole.
  Eigen::Matrix3d& at(std::size_t i, std::size_t below) { return rows_[i][below]; }
  [[nodiscard]] const Eigen::Matrix3d& at(std::size_t i, std::size_t below) const {
    return rows_[i][below];
  }

  // Leaves unknown i the directions that the projector `free` keeps: in the others the solution
  // is 0, if the right side is 0 there.
  void restrict(std::size_t i, const Eigen::Matrix3d& free);

  // Replaces the matrix by its Cholesky factor. Returns false when a pivot is not positive.
  [[nodiscard]] bool factor();

  // After factor(): `right` becomes the solution.
  void solve(std::vector<Point3>& right) const;

 private:
  using Row = std::array<Eigen::Matrix3d, kBands + 1>;  // diagonal first, then below
  std::vector<Row> rows_;
};

}  // namespace batten::geometry
