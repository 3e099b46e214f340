// A cubic Bezier piece as a polynomial, for many evaluations of it and its derivatives.
#pragma once

#include <vector>

#include "geometry/basic/point.h"
#include "geometry/numeric/cubic_roots.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// c0 + c1 t + c2 t^2 + c3 t^3 for t in [0, 1], from a fixed place. Near that place it is right
// to rounding, also where the coordinates are great.
class CubicPolynomial {
 public:
  explicit CubicPolynomial(const CubicBezier& b, const Point3& origin = Point3::Zero())
      : c0_(b.control[0] - origin),
        c1_(3 * (b.control[1] - b.control[0])),
        c2_(3 * (b.control[2] - 2 * b.control[1] + b.control[0])),
        c3_(b.control[3] - 3 * b.control[2] + 3 * b.control[1] - b.control[0]) {}

  [[nodiscard]] Vector3 value(double t) const { return c0_ + t * (c1_ + t * (c2_ + t * c3_)); }
  [[nodiscard]] Vector3 first(double t) const { return c1_ + t * (2 * c2_ + 3 * t * c3_); }
  [[nodiscard]] Vector3 second(double t) const { return 2 * c2_ + 6 * t * c3_; }
  [[nodiscard]] Vector3 third() const { return 6 * c3_; }

  // Appends offset + t for the places t in [0, 1] where the value has no part along `direction`.
  void append_crossings(const Vector3& direction, double offset,
                        std::vector<double>& places) const {
    append_cubic_roots(c0_.dot(direction), c1_.dot(direction), c2_.dot(direction),
                       c3_.dot(direction), offset, places);
  }

  // The same where the first derivative is shortest or longest: normal to the second.
  void append_speed_extrema(double offset, std::vector<double>& places) const {
    append_cubic_roots(c1_.dot(c2_), 3 * c1_.dot(c3_) + 2 * c2_.squaredNorm(), 9 * c2_.dot(c3_),
                       9 * c3_.squaredNorm(), offset, places);
  }

 private:
  Vector3 c0_;
  Vector3 c1_;
  Vector3 c2_;
  Vector3 c3_;
};

}  // namespace batten::geometry
