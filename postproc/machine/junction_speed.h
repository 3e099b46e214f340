// What the axes allow along a direction, and how fast a control passes a joint of two pieces.
#pragma once

#include "geometry/point.h"

namespace batten::postproc {

// The greatest length of a vector along the unit vector `direction` none of whose
// components is above `axis_limit`.
[[nodiscard]] double limit_along(const geometry::Vector3& direction, double axis_limit);

// grbl's junction deviation: the speed on the circle that touches both directions and
// passes the corner at `deviation` (mm), under `axis_acceleration` (mm/s^2) of each axis.
// No limit where the path runs straight on, 0 where it turns back.
[[nodiscard]] double junction_deviation_speed(const geometry::Vector3& before,
                                              const geometry::Vector3& after, double deviation,
                                              double axis_acceleration);

// The speed at which no axis changes its velocity by more than `axis_acceleration` does in
// one `period` (s).
[[nodiscard]] double velocity_step_speed(const geometry::Vector3& before,
                                         const geometry::Vector3& after, double axis_acceleration,
                                         double period);

}  // namespace batten::postproc
