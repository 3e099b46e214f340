// The three planes of G17, G18 and G19 by their axes.
#pragma once

#include <array>
#include <cmath>

#include "gcode/state/modal_state.h"
#include "geometry/basic/point.h"
#include "geometry/basic/rounding.h"

namespace batten::gcode {

// A plane's axes (0, 1, 2 for X, Y, Z) in the order in which its normal is right-handed: seen from
// the tip of +Y, the way from Z to X is counter-clockwise, so G18 has Z before X and G3 is
// counter-clockwise in all three.
struct PlaneAxes {
  Plane plane = Plane::kUnknown;
  int first = 0;
  int second = 1;
  int normal = 2;
};

inline constexpr std::array<PlaneAxes, 3> kPlaneAxes = {
    PlaneAxes{Plane::kXY, 0, 1, 2}, PlaneAxes{Plane::kZX, 2, 0, 1}, PlaneAxes{Plane::kYZ, 1, 2, 0}};

// The plane across a unit vector of either sign; nothing when it is no axis of the coordinate
// system.
[[nodiscard]] inline const PlaneAxes* plane_across(const geometry::Vector3& axis) {
  for (const PlaneAxes& plane : kPlaneAxes) {
    if (std::abs(std::abs(axis[plane.normal]) - 1) < geometry::kSameDirection) return &plane;
  }
  return nullptr;
}

}  // namespace batten::gcode
