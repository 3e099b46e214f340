// What the axes allow along a direction, and how fast a control passes a joint of two pieces.
#pragma once

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

// Limits of X, Y and Z.
[[nodiscard]] geometry::Vector3 axis_velocities(const Machine& machine, bool rapid);  // mm/s
[[nodiscard]] geometry::Vector3 axis_accelerations(const Machine& machine);           // mm/s^2
[[nodiscard]] geometry::Vector3 axis_jerks(const Machine& machine);  // mm/s^3, may be infinite

// What a plan of these axes keeps at a feed (mm/min).
[[nodiscard]] KinematicPathLimits kinematic_limits(const Machine& machine, double feed, bool rapid);

// The greatest length of a vector along the unit vector `direction` none of whose components
// is above its axis' limit.
[[nodiscard]] double limit_along(const geometry::Vector3& direction,
                                 const geometry::Vector3& limits);

// The same for all directions across the unit vector `normal`.
[[nodiscard]] double limit_across(const geometry::Vector3& normal, const geometry::Vector3& limits);

// The same for all directions that the piece turns through: along a line its own, across the axis
// of a flat arc, of a cubic piece any of the axes that it moves, otherwise any.
[[nodiscard]] double limit_on(const geometry::PathPiece& piece, const geometry::Vector3& limits);

// The harmonic mean of what the directions along the piece allow.
[[nodiscard]] double mean_limit_on(const geometry::PathPiece& piece,
                                   const geometry::Vector3& limits);

// 1/mm, of its ends and its middle.
[[nodiscard]] double greatest_curvature(const geometry::PathPiece& piece);

// grbl's junction deviation: the speed on the circle that touches both directions and
// passes the corner at `deviation` (mm), under `acceleration` (mm/s^2) of each axis.
// No limit where the path runs straight on, 0 where it turns back.
[[nodiscard]] double junction_deviation_speed(const geometry::Vector3& before,
                                              const geometry::Vector3& after, double deviation,
                                              const geometry::Vector3& acceleration);

// The speed at which no axis changes its velocity by more than its `acceleration` (mm/s^2) does
// in one `period` (s).
[[nodiscard]] double velocity_step_speed(const geometry::Vector3& before,
                                         const geometry::Vector3& after,
                                         const geometry::Vector3& acceleration, double period);

}  // namespace batten::postproc
