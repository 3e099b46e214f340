// Points and vectors in space.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace batten::geometry {

// A place in space. Millimetres, absolute.
using Point3 = Eigen::Vector3d;

// A difference of places, or a direction.
using Vector3 = Eigen::Vector3d;

}  // namespace batten::geometry
