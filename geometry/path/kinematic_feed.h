// The feed that a machine's axes allow on a curve if it were held all along: a guess that needs
// no planning.
#pragma once

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// Per axis x, y, z.
struct KinematicLimits {
  double feed = 25;                                  // mm/s
  Vector3 speed = Vector3::Constant(500);            // mm/s
  Vector3 acceleration = Vector3(2500, 3000, 3000);  // mm/s^2
  Vector3 jerk = Vector3::Constant(5000);            // mm/s^3
};

// Of the place x by the length s.
struct LengthDerivatives {
  Vector3 first = Vector3::Zero();   // unit direction
  Vector3 second = Vector3::Zero();  // 1/mm
  Vector3 third = Vector3::Zero();   // 1/mm^2

  [[nodiscard]] bool is_straight() const { return second.isZero(0) && third.isZero(0); }
};

// From those by another parameter, the first not zero: the chain rule.
[[nodiscard]] LengthDerivatives by_length(const Vector3& d1, const Vector3& d2, const Vector3& d3);

// mm/s: the least over curve and axes of V / |x_s|, sqrt(A / |x_ss|) and cbrt(J / |x_sss|), at
// most `feed`; x_s .. are derivatives by length, the third from both sides at the knots. By samples
// that are refined around the least ones. Requires degree 3 or less.
[[nodiscard]] double feed_estimate(const BsplineCurve& curve, const KinematicLimits& limits);

}  // namespace batten::geometry
