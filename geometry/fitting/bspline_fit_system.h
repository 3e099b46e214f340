// The cubic spline of a fit while it is made: its knots, what is known of its control points, its
// energy, and the basis values at the samples. And the normal equations for a range of its control
// points, all others held where they are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/fitting/bspline_fit_weights.h"
#include "geometry/fitting/fit_problem.h"
#include "geometry/numeric/banded_cholesky.h"

namespace batten::geometry {

struct FitSpline {
  std::vector<double> breaks;       // distinct knots, increasing
  std::vector<double> knots;        // fourfold at the ends, threefold at inner pins
  std::vector<Point3> points;       // control points
  std::vector<std::uint8_t> fixed;  // per control point: its place is known, by a pin or a zone

  // Integrals of the products of third derivatives: energy[i][k] belongs to i and i - k.
  std::vector<std::array<double, 4>> energy;

  [[nodiscard]] std::size_t size() const { return points.size(); }
};

// The spline on these breakpoints; control points that are not fixed are at the origin. Throws
// std::invalid_argument when a pin or the end of a zone is no breakpoint.
[[nodiscard]] FitSpline spline_on(std::vector<double> breaks, std::span<const Pin> pins,
                                  std::span<const StraightZone> zones);

inline constexpr std::size_t kNotCarried = static_cast<std::size_t>(-1);

// Takes over the control points of `before` whose knots are the same in `after`; a place that is
// fixed in one of them has to be so in the other. Gives the new index of every old one, or
// kNotCarried.
[[nodiscard]] std::vector<std::size_t> carry_points(const FitSpline& before, FitSpline& after);

// The four basis functions that are not zero at a sample.
struct FitRow {
  std::size_t first = 0;  // the first of four control points
  std::array<double, 4> value{};
};

// The row at u, on the last span from `span` on that does not start behind it; `span` moves there.
[[nodiscard]] FitRow row_at(const FitSpline& spline, double u, std::size_t& span);

// The curve at a sample.
[[nodiscard, gnu::always_inline]] inline Point3 place_of(const FitRow& row,
                                                         std::span<const Point3> points) {
  const Point3* p = &points[row.first];
  return row.value[0] * p[0] + row.value[1] * p[1] + row.value[2] * p[2] + row.value[3] * p[3];
}

// Indices [begin, end[.
struct IndexRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

// The normal equations. Memory is kept from one solution to the next.
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
