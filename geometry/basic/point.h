// Points and vectors in space and in the plane.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace batten::geometry {

// A place in space. Millimetres, absolute.
using Point3 = Eigen::Vector3d;

// A difference of places, or a direction.
using Vector3 = Eigen::Vector3d;

// The same in a plane.
using Point2 = Eigen::Vector2d;
using Vector2 = Eigen::Vector2d;

}  // namespace batten::geometry
