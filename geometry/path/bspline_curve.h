// A polynomial B-spline curve in space.
#pragma once

#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_basis.h"
#include "geometry/path/path.h"

namespace batten::geometry {

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

  // Unit tangent; where the first derivative vanishes, the direction in which the curve
  // leaves that place (arrives, at the end of the curve).
  [[nodiscard]] Vector3 direction_at(double u) const;

  // 1/mm; 0 where the first derivative vanishes.
  [[nodiscard]] double curvature_at(double u) const;

  // The part between two parameters, with the same parameters, clamped at both ends.
  // Requires first() <= from < to <= last().
  [[nodiscard]] BsplineCurve part(double from, double to) const;

  // Distinct knots of [first, last], increasing.
  [[nodiscard]] std::vector<double> breakpoints() const;

  // One cubic Bezier piece per span of breakpoints(); piece i runs over
  // [breakpoints[i], breakpoints[i + 1]]. Requires degree 3 or less. Linear cost.
  [[nodiscard]] std::vector<CubicBezier> bezier_pieces() const;

  // The same curve run backwards on the same parameter interval.
  [[nodiscard]] BsplineCurve reversed() const;

 private:
  BsplineBasis basis_;
  std::vector<Point3> control_points_;
};

// Length in mm between two parameters, Gauss-Legendre per span, relative error below 1e-6
// on spans whose speed changes by less than a factor of ten.
[[nodiscard]] double length_between(const BsplineCurve& curve, double from, double to);

}  // namespace batten::geometry
