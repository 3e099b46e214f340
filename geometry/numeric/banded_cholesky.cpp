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

// Row i of L D L^T, and of L y = right on the way: rows_[i][k] becomes L(i, i-k), rows_[i][0]
// becomes 1 / D(i). `kBefore`: the rows above that it touches.
template <int kBefore, typename Value>
bool BandedMatrix::eliminate(std::size_t i, std::vector<Value>& right) {
  Row row = rows_[i];
#pragma GCC unroll 3
  for (int k = kBefore; k >= 1; --k) {
    // row[k] still holds L(i, i-k) * D(i-k) of the entries further left.
#pragma GCC unroll 3
    for (int m = k + 1; m <= kBefore; ++m) row[k] -= row[m] * rows_[i - k][m - k];
  }
  double diagonal = row[0];
  Value value = right[i];
#pragma GCC unroll 3
  for (int k = kBefore; k >= 1; --k) {
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
}

// Row i of D and of the transpose of L. `kBehind`: the rows below that it touches.
template <int kBehind, typename Value>
void BandedMatrix::back_substitute(std::size_t i, std::vector<Value>& right) const {
  Value value = right[i] * rows_[i][0];
#pragma GCC unroll 3
  for (int k = 1; k <= kBehind; ++k) value -= rows_[i + k][k] * right[i + k];
  right[i] = value;
}

template <typename Value>
bool BandedMatrix::solve(std::vector<Value>& right) {
  const std::size_t n = rows_.size();
  if (n > 0 && !eliminate<0>(0, right)) return false;
  if (n > 1 && !eliminate<1>(1, right)) return false;
  if (n > 2 && !eliminate<2>(2, right)) return false;
  for (std::size_t i = 3; i < n; ++i) {
    if (!eliminate<3>(i, right)) return false;
  }
  if (n > 0) back_substitute<0>(n - 1, right);
  if (n > 1) back_substitute<1>(n - 2, right);
  if (n > 2) back_substitute<2>(n - 3, right);
  for (std::size_t i = n; i-- > 3;) back_substitute<3>(i - 3, right);
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
