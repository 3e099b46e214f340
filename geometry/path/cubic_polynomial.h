// A cubic Bezier piece as a polynomial, for many evaluations of it and its derivatives.
#pragma once

#include <type_traits>
#include <utility>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/numeric/extrema.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// c0 + c1 t + c2 t^2 + c3 t^3 for t in [0, 1], from a fixed position, near which it is right to
// rounding where the coordinates are great, too.
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

  // Appends offset + t for each t in [0, 1] where the value has no part along `direction`.
  void append_crossings(const Vector3& direction, double offset,
                        std::vector<double>& places) const {
    append_cubic_roots(c0_.dot(direction), c1_.dot(direction), c2_.dot(direction),
                       c3_.dot(direction), offset, places);
  }

  // The same where the value's part along `direction` is least or greatest.
  void append_extrema(const Vector3& direction, double offset, std::vector<double>& places) const {
    append_cubic_roots(c1_.dot(direction), 2 * c2_.dot(direction), 3 * c3_.dot(direction), 0,
                       offset, places);
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

// The two parts before and after t in ]0, 1[, each for t in [0, 1] again. `Cubic` holds four
// points `control`, in the plane or in space, and nothing else. De Casteljau's algorithm.
template <typename Cubic>
[[nodiscard]] std::pair<Cubic, Cubic> parts_at(const Cubic& piece, double t) {
  const auto& p = piece.control;
  using Point = std::remove_cvref_t<decltype(p[0])>;
  const double s = 1 - t;
  const Point first = s * p[0] + t * p[1];
  const Point second = s * p[1] + t * p[2];
  const Point third = s * p[2] + t * p[3];
  const Point left = s * first + t * second;
  const Point right = s * second + t * third;
  const Point middle = s * left + t * right;
  return {Cubic{{p[0], first, left, middle}}, Cubic{{middle, right, third, p[3]}}};
}

template <typename Cubic>
[[nodiscard]] std::pair<Cubic, Cubic> halves(const Cubic& piece) {
  return parts_at(piece, 0.5);
}

}  // namespace batten::geometry
