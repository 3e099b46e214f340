// B-spline basis functions of one knot vector.
//
// A basis of degree p with m functions has m + p + 1 knots t_0 <= t_1 <= ... ; the curve
// lives on [t_p, t_m]. Source of the recurrences: C. de Boor, A Practical Guide to Splines
// (1978), chapter X; L. Piegl, W. Tiller, The NURBS Book (1997), algorithms A2.1 to A2.3.
#pragma once

#include <cstddef>
#include <vector>

namespace batten::geometry {

inline constexpr int kMaxDegree = 5;

class BsplineBasis {
 public:
  // Throws std::invalid_argument when the degree is not in 1..kMaxDegree, when there are
  // fewer than 2 * (degree + 1) knots, when knots decrease, or when [t_p, t_m] is empty.
  BsplineBasis(int degree, std::vector<double> knots);

  // Clamped knots: every end breakpoint degree + 1 times, the inner ones once.
  // Breakpoints must increase strictly.
  [[nodiscard]] static BsplineBasis clamped(int degree, const std::vector<double>& breakpoints);

  [[nodiscard]] int degree() const { return degree_; }
  [[nodiscard]] const std::vector<double>& knots() const { return knots_; }
  [[nodiscard]] std::size_t size() const { return knots_.size() - degree_ - 1; }  // functions
  [[nodiscard]] double first() const { return knots_[degree_]; }
  [[nodiscard]] double last() const { return knots_[size()]; }

  // The k with t_k <= u < t_{k+1}, p <= k < m; the last non-empty span for u = last().
  // Parameters outside [first, last] count as the nearer end.
  [[nodiscard]] std::size_t find_span(double u) const;

  // The degree + 1 functions that are not zero on span k, at u: values[0] belongs to
  // function k - degree.
  void evaluate(std::size_t span, double u, double* values) const;

  // The same with derivatives: values[d * (degree + 1) + j] is the d-th derivative of
  // function k - degree + j, d = 0..derivatives. Derivatives above the degree are 0.
  void evaluate_derivatives(std::size_t span, double u, int derivatives, double* values) const;

  // The parameter at which the control polygon of a straight line has point i:
  // (t_{i+1} + ... + t_{i+p}) / p.
  [[nodiscard]] double greville(std::size_t i) const;

 private:
  int degree_;
  std::vector<double> knots_;
};

}  // namespace batten::geometry
