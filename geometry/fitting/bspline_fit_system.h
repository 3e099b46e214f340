// The normal equations of a fit for a range of its control points, all others held where they are.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/fitting/bspline_fit_spline.h"
#include "geometry/fitting/bspline_fit_weights.h"
#include "geometry/numeric/banded_cholesky.h"

namespace batten::geometry {

// Indices [begin, end[.
struct IndexRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

// Memory is kept from one solution to the next.
class FitSystem {
 public:
  // Minimises energy + sum of weight * |curve - target|^2 over the control points `free`.
  // `samples` are those whose rows touch them. Returns false when the system is singular.
  [[nodiscard]] bool solve(const FitSpline& spline, std::span<const FitRow> rows,
                           std::span<const SampleState> states, IndexRange samples,
                           IndexRange free);

  // After solve(): the new place of a control point of `free`.
  [[nodiscard]] const Point3& place(std::size_t point) const { return right_[point - offset_]; }

  // After solve(): the inverse, as far as leverage() needs it for rows that start at `first_point`
  // or behind.
  void invert(const FitSpline& spline, std::size_t first_point);

  // After invert(): the compliance of the curve at a sample, how far a unit force moves it.
  [[nodiscard]] double leverage(const FitRow& row) const;

 private:
  void add_samples(std::span<const FitRow> rows, std::span<const SampleState> states,
                   IndexRange samples);
  void add_sample(const FitRow& row, const SampleState& state);
  [[nodiscard]] bool is_held(const FitSpline& spline, std::size_t point) const {
    return point < free_.begin || point >= free_.end || spline.fixed[point] != 0;
  }

  BandedMatrix matrix_{0};
  BandedMatrix inverse_{0};
  std::vector<Point3> right_;
  std::size_t offset_ = 0;  // control point of the first row
  IndexRange free_;
};

}  // namespace batten::geometry
