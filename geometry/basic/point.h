// Points and vectors in space and in the plane.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace batten::geometry {

// A place in space. Millimetres, absolute.
using Point3 = Eigen::Vector3d;

// A difference of places, or a direction.
using Vector3 = Eigen::Vector3d;

// The same in a plane.
using Point2 = Eigen::Vector2d;
using Vector2 = Eigen::Vector2d;

// mm, between a place and a segment, in space or in a plane; a segment without length is its place.
template <typename Point>
[[nodiscard]] double distance_to_segment(const Point& place, const Point& from, const Point& to) {
  const Point along = to - from;
  const double square = along.squaredNorm();
  const double part = square > 0 ? std::clamp((place - from).dot(along) / square, 0.0, 1.0) : 0.0;
  return (place - from - part * along).norm();
}

// Angles in radians.

inline constexpr double kPi = std::numbers::pi;

// The same direction within half a turn of zero, either way.
[[nodiscard]] inline double wrapped(double angle) { return std::remainder(angle, 2 * kPi); }

}  // namespace batten::geometry
