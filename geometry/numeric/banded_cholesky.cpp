#include "geometry/numeric/banded_cholesky.h"

#include <algorithm>

namespace batten::geometry {

void BandedMatrix::fix(std::size_t i, const Point3& value, std::vector<Point3>& right) {
  const int before = static_cast<int>(std::min<std::size_t>(i, kBands));
  for (int k = 1; k <= before; ++k) {
    right[i - k] -= rows_[i][k] * value;
    rows_[i][k] = 0;
  }
  for (int k = 1; k <= kBands && i + k < rows_.size(); ++k) {
    right[i + k] -= rows_[i + k][k] * value;
    rows_[i + k][k] = 0;
  }
  rows_[i][0] = 1;
  right[i] = value;
}

template <typename Value>
bool BandedMatrix::solve(std::vector<Value>& right) {
  // Row i of L D L^T, and of L y = right on the way: rows_[i][k] becomes L(i, i-k), rows_[i][0]
  // becomes 1 / D(i). `before`: the rows above that it touches; known while compiling but for the
  // first rows, so that loops are unrolled.
  const auto eliminate = [&](std::size_t i, int before) __attribute__((always_inline)) {
    Row row = rows_[i];
#pragma GCC unroll 3
    for (int k = before; k >= 1; --k) {
      // row[k] still holds L(i, i-k) * D(i-k) of the entries further left.
#pragma GCC unroll 3
      for (int m = k + 1; m <= before; ++m) row[k] -= row[m] * rows_[i - k][m - k];
    }
    double diagonal = row[0];
    Value value = right[i];
#pragma GCC unroll 3
    for (int k = before; k >= 1; --k) {
      const double scaled = row[k] * rows_[i - k][0];
      diagonal -= scaled * row[k];
      row[k] = scaled;
      value -= scaled * right[i - k];
    }
    if (!(diagonal > 0)) return false;
    row[0] = 1 / diagonal;
    rows_[i] = row;
    right[i] = value;
    return true;
  };
  const std::size_t n = rows_.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int before = static_cast<int>(std::min<std::size_t>(i, kBands));
    if (!(before < kBands ? eliminate(i, before) : eliminate(i, kBands))) return false;
  }
  for (std::size_t i = n; i-- > 0;) {
    Value value = right[i] * rows_[i][0];
    for (std::size_t k = 1; k <= kBands && i + k < n; ++k) value -= rows_[i + k][k] * right[i + k];
    right[i] = value;
  }
  return true;
}

template bool BandedMatrix::solve(std::vector<Point3>& right);
template bool BandedMatrix::solve(std::vector<double>& right);

void BandedMatrix::inverse_band(BandedMatrix& inverse, std::size_t first) const {
  // From L D L^T: row i of the inverse is D^-1 minus the columns of L times the rows below,
  // Z(i, j) = [i = j] / D(i) - sum over k > i of L(k, i) Z(k, j), which stays inside the band.
  const std::size_t n = rows_.size();
  inverse.reset(n);
  auto& z = inverse.rows_;
  // Of the three rows below: Z(i+1, i+1), Z(i+2, i+1) and so on; all zero below the last row.
  double z11 = 0, z21 = 0, z22 = 0, z31 = 0, z32 = 0, z33 = 0;
  for (std::size_t i = n; i-- > first;) {
    const std::size_t below = std::min<std::size_t>(n - 1 - i, kBands);
    const double l1 = below > 0 ? rows_[i + 1][1] : 0;
    const double l2 = below > 1 ? rows_[i + 2][2] : 0;
    const double l3 = below > 2 ? rows_[i + 3][3] : 0;
    const double z3 = -(l1 * z31 + l2 * z32 + l3 * z33);
    const double z2 = -(l1 * z21 + l2 * z22 + l3 * z32);
    const double z1 = -(l1 * z11 + l2 * z21 + l3 * z31);
    const double diagonal = rows_[i][0] - l1 * z1 - l2 * z2 - l3 * z3;
    if (below > 2) z[i + 3][3] = z3;
    if (below > 1) z[i + 2][2] = z2;
    if (below > 0) z[i + 1][1] = z1;
    z[i][0] = diagonal;
    z33 = z22, z32 = z21, z31 = z2, z22 = z11, z21 = z1, z11 = diagonal;
  }
}

}  // namespace batten::geometry
