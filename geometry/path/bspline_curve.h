// A polynomial B-spline curve in space.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::geometry {

inline constexpr int kMaxDegree = 5;

class BsplineBasis {
 public:
  // Throws std::invalid_argument when the degree is not in 1..kMaxDegree, there are fewer than
  // 2 * (degree + 1) knots, knots decrease, or [t_p, t_m] is empty.
  BsplineBasis(int degree, std::vector<double> knots);

  // Every end breakpoint degree + 1 times, the inner ones once. They must increase strictly.
  [[nodiscard]] static BsplineBasis clamped(int degree, const std::vector<double>& breakpoints);

  [[nodiscard]] int degree() const { return degree_; }
  [[nodiscard]] const std::vector<double>& knots() const { return knots_; }
  [[nodiscard]] std::size_t size() const { return knots_.size() - degree_ - 1; }  // functions
  [[nodiscard]] double first() const { return knots_[degree_]; }
  [[nodiscard]] double last() const { return knots_[size()]; }

  // The k with t_k <= u < t_{k+1}, p <= k < m; the last non-empty span for u = last(). Parameters
  // outside [first, last] count as the nearer end.
  [[nodiscard]] std::size_t find_span(double u) const;

  // The degree + 1 functions that are not zero on span k, at u: values[0] is function k - degree.
  void evaluate(std::size_t span, double u, double* values) const;

  // The same with derivatives: values[d * (degree + 1) + j] is the d-th derivative of function
  // k - degree + j, d = 0..derivatives. Derivatives above the degree are 0.
  void evaluate_derivatives(std::size_t span, double u, int derivatives, double* values) const;

  // Where the control polygon of a straight line has point i: (t_{i+1} + ... + t_{i+p}) / p.
  [[nodiscard]] double greville(std::size_t i) const;

 private:
  int degree_;
  std::vector<double> knots_;
};

// The blossom (polar form) of the polynomial of one span: symmetric, affine in each of its
// arguments, as many as the degree, and the polynomial itself where all are equal. Control points
// are blossoms of consecutive knots (L. Ramshaw 1987), so knots need not be inserted one by one.
// Points may be homogeneous.
template <typename Point>
Point blossom(const BsplineBasis& basis, std::span<const Point> points, std::size_t span,
              std::span<const double> arguments) {
  const auto p = static_cast<std::size_t>(basis.degree());
  const auto& t = basis.knots();
  std::array<Point, kMaxDegree + 1> d;
  for (std::size_t j = 0; j <= p; ++j) d[j] = points[span - p + j];
  for (std::size_t r = 1; r <= p; ++r) {
    for (std::size_t j = p; j >= r; --j) {
      const std::size_t i = span - p + j;
      const double alpha = (arguments[r - 1] - t[i]) / (t[i + 1 + p - r] - t[i]);
      d[j] = (1 - alpha) * d[j - 1] + alpha * d[j];
    }
  }
  return d[p];
}

class BsplineCurve {
 public:
  // Throws std::invalid_argument when the number of control points is not basis.size().
  BsplineCurve(BsplineBasis basis, std::vector<Point3> control_points);

  [[nodiscard]] const BsplineBasis& basis() const { return basis_; }
  [[nodiscard]] int degree() const { return basis_.degree(); }
  [[nodiscard]] const std::vector<Point3>& control_points() const { return control_points_; }
  [[nodiscard]] double first() const { return basis_.first(); }
  [[nodiscard]] double last() const { return basis_.last(); }

  [[nodiscard]] Point3 point_at(double u) const;

  // The order-th derivative by u, from the right (from the left at last()).
  [[nodiscard]] Vector3 derivative_at(double u, int order) const;

  // Unit tangent; where the first derivative vanishes, the direction in which the curve leaves
  // (arrives, at its end).
  [[nodiscard]] Vector3 direction_at(double u) const;

  // 1/mm; 0 where the first derivative vanishes.
  [[nodiscard]] double curvature_at(double u) const;

  // The part between two parameters, with the same parameters, clamped at both ends.
  // Requires first() <= from < to <= last().
  [[nodiscard]] BsplineCurve part(double from, double to) const;

  // Distinct knots of [first, last], increasing.
  [[nodiscard]] std::vector<double> breakpoints() const;

  // One for each span of breakpoints(), in order. Requires degree 3 or less. Linear cost.
  [[nodiscard]] std::vector<CubicBezier> bezier_pieces() const;

 private:
  BsplineBasis basis_;
  std::vector<Point3> control_points_;
};

// A closed cubic that has no seam: it ends where it begins with the same first and second
// derivatives. The control points go round once, and curve begins beside the first of them, which
// is not repeated; the breakpoints are one more and increase strictly. The result is clamped there.
//
// Throws std::invalid_argument where they do not, or for fewer than 3 control points.
[[nodiscard]] BsplineCurve ring_of(const std::vector<double>& breakpoints,
                                   const std::vector<Point3>& control_points);

// How far a curve was moved when another one with the same knots was made of it: D(u) = C(u) -
// C0(u) is a spline whose control points are the moves of the control points. For each span of
// displacement.breakpoints() a bound (mm) on |D| that holds for every u, above the greatest |D| of
// the span by `slack` (mm, > 0) at most. Requires degree 3 or less.
[[nodiscard]] std::vector<double> displacement_bounds(const BsplineCurve& displacement,
                                                      double slack);

}  // namespace batten::geometry
