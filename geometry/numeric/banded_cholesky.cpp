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
    // The one solved for last comes last: the others need not wait for it.
    for (std::size_t k = std::min<std::size_t>(kBands, n - 1 - i); k > 0; --k) {
      value -= rows_[i + k][k] * right[i + k];
    }
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
  const auto entry = [&](std::size_t a, std::size_t b) {
    return a >= b ? z[a][a - b] : z[b][b - a];
  };
  for (std::size_t i = n; i-- > first;) {
    const std::size_t last = std::min(i + kBands, n - 1);
    for (std::size_t j = last; j > i; --j) {
      double sum = 0;
      for (std::size_t k = i + 1; k <= last; ++k) sum -= rows_[k][k - i] * entry(k, j);
      z[j][j - i] = sum;
    }
    double diagonal = rows_[i][0];
    for (std::size_t k = i + 1; k <= last; ++k) diagonal -= rows_[k][k - i] * entry(k, i);
    z[i][0] = diagonal;
  }
}

}  // namespace batten::geometry
