#include "geometry/fitting/band_curve_matrix.h"

#include <algorithm>
#include <cmath>

namespace batten::geometry {

namespace {

using Eigen::Matrix3d;

// The lower triangle with l * l^T = m; of `m` only the lower half is read.
bool lower_root(Matrix3d& m) {
  Matrix3d l = Matrix3d::Zero();
  for (int j = 0; j < 3; ++j) {
    for (int i = j; i < 3; ++i) {
      double sum = m(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * l(j, k);
      if (i > j) {
        l(i, j) = sum / l(j, j);
        continue;
      }
      if (!(sum > 0)) return false;
      l(j, j) = std::sqrt(sum);
    }
  }
  m = l;
  return true;
}

// x * l^-T, l lower.
void divide_by_transposed(Matrix3d& x, const Matrix3d& l) {
  for (int i = 0; i < 3; ++i) {
    x(i, 0) /= l(0, 0);
    x(i, 1) = (x(i, 1) - x(i, 0) * l(1, 0)) / l(1, 1);
    x(i, 2) = (x(i, 2) - x(i, 0) * l(2, 0) - x(i, 1) * l(2, 1)) / l(2, 2);
  }
}

void forwards(const Matrix3d& l, Point3& x) {
  x[0] /= l(0, 0);
  x[1] = (x[1] - l(1, 0) * x[0]) / l(1, 1);
  x[2] = (x[2] - l(2, 0) * x[0] - l(2, 1) * x[1]) / l(2, 2);
}

void backwards(const Matrix3d& l, Point3& x) {
  x[2] /= l(2, 2);
  x[1] = (x[1] - l(2, 1) * x[2]) / l(1, 1);
  x[0] = (x[0] - l(1, 0) * x[1] - l(2, 0) * x[2]) / l(0, 0);
}

}  // namespace

void BlockBandedMatrix::set_zero() {
  for (Row& row : rows_) row.fill(Matrix3d::Zero());
}

void BlockBandedMatrix::restrict(std::size_t i, const Matrix3d& free) {
  const std::size_t before = std::min(i, kBands);
  for (std::size_t k = 1; k <= before; ++k) rows_[i][k] = free * rows_[i][k];
  for (std::size_t k = 1; k <= kBands && i + k < rows_.size(); ++k) {
    rows_[i + k][k] = rows_[i + k][k] * free;
  }
  rows_[i][0] = free * rows_[i][0] * free + (Matrix3d::Identity() - free);
}

bool BlockBandedMatrix::factor() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    Row& row = rows_[i];
    const std::size_t before = std::min(i, kBands);
    for (std::size_t k = before; k >= 1; --k) {
      for (std::size_t m = k + 1; m <= before; ++m) {
        row[k].noalias() -= row[m] * rows_[i - k][m - k].transpose();
      }
      divide_by_transposed(row[k], rows_[i - k][0]);
    }
    for (std::size_t k = 1; k <= before; ++k) row[0].noalias() -= row[k] * row[k].transpose();
    if (!lower_root(row[0])) return false;
  }
  return true;
}

void BlockBandedMatrix::solve(std::vector<Point3>& right) const {
  const std::size_t n = rows_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t before = std::min(i, kBands);
    for (std::size_t k = 1; k <= before; ++k) right[i].noalias() -= rows_[i][k] * right[i - k];
    forwards(rows_[i][0], right[i]);
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = 1; k <= kBands && i + k < n; ++k) {
      right[i].noalias() -= rows_[i + k][k].transpose() * right[i + k];
    }
    backwards(rows_[i][0], right[i]);
  }
}

}  // namespace batten::geometry
