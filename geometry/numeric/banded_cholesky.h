// Symmetric positive definite systems with three sub-diagonals, as cubic B-splines give them,
// factored and solved for points or numbers in linear time.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"

namespace batten::geometry {

class BandedMatrix {
 public:
  static constexpr int kBands = 3;  // below the diagonal

  explicit BandedMatrix(std::size_t size) : rows_(size, Row{}) {}

  [[nodiscard]] std::size_t size() const { return rows_.size(); }

  // A row: the diagonal first, then the entries below it.
  using Row = std::array<double, kBands + 1>;

  // All zero and of another size; memory is kept for the next one.
  void reset(std::size_t size) { rows_.assign(size, Row{}); }

  // These rows; memory is kept. Of the first ones, entries that would be left of the matrix count
  // for nothing.
  void set_rows(std::span<const Row> rows) { rows_.assign(rows.begin(), rows.end()); }

  // Entry (i, i - below), 0 <= below <= kBands, below <= i. The matrix is symmetric: only
  // the lower half is kept.
  double& at(std::size_t i, int below) { return rows_[i][below]; }
  [[nodiscard]] double at(std::size_t i, int below) const { return rows_[i][below]; }

  // Replaces row and column i by the unit row, moving `value` times the column to `right`:
  // the unknown i is then exactly `value`.
  void fix(std::size_t i, const Point3& value, std::vector<Point3>& right);

  // Solves in place: `right` becomes the solution. The matrix is overwritten by its factors
  // (L D L^T, with the inverse of D). Returns false when a pivot is not positive; `right` is
  // undefined then. `Value`: Point3 or double.
  template <typename Value>
  [[nodiscard]] bool solve(std::vector<Value>& right);

  // After solve(): the entries of the inverse inside the band, as another banded matrix
  // (K. Takahashi et al. 1973), in its memory; only from row `first` on: the rows before it stay
  // zero. Linear time.
  void inverse_band(BandedMatrix& inverse, std::size_t first) const;

 private:
  std::vector<Row> rows_;
};

}  // namespace batten::geometry
