// A path as its feed plan sees it: derivatives by length at a place, and lengths of parts.
#pragma once

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_limits.h"

namespace batten::postproc {

// Of the place x by the length s.
struct LengthDerivatives {
  geometry::Vector3 first = geometry::Vector3::Zero();   // unit direction
  geometry::Vector3 second = geometry::Vector3::Zero();  // 1/mm
  geometry::Vector3 third = geometry::Vector3::Zero();   // 1/mm^2
};

// Exact for lines, arcs, helices, spirals and Bezier pieces. Where a Bezier piece comes to a
// rest in its parameter (control points that coincide), those of a place close by.
[[nodiscard]] LengthDerivatives derivatives_by_length(const geometry::PathPiece& piece, double t);

// mm between two parameters, five-point Gauss-Legendre: for parts over which the speed of the
// parameter changes little.
[[nodiscard]] double length_between(const geometry::PathPiece& piece, double t0, double t1);

// What a joint of two pieces allows: mm/s, infinity where the path runs on in direction and
// curvature.
[[nodiscard]] double joint_speed(const LengthDerivatives& before, const LengthDerivatives& after,
                                 const KinematicPathLimits& limits);

}  // namespace batten::postproc
