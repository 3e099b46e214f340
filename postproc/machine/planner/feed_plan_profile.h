// A feed plan in time, as a control would send it to the axes.
#pragma once

#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"

namespace batten::postproc {

struct MotionSample {
  double time = 0;                     // s
  double speed = 0;                    // mm/s along the path
  double tangential_acceleration = 0;  // mm/s^2
  double tangential_jerk = 0;          // mm/s^3
  geometry::Point3 position;
  geometry::Vector3 velocity;      // mm/s
  geometry::Vector3 acceleration;  // mm/s^2
  geometry::Vector3 jerk;          // mm/s^3
};

// The state every `period` seconds from 0 on, the end of the plan not included. `path` is the one
// that was planned.
//
// Throws std::invalid_argument where the period is not above 0.
[[nodiscard]] std::vector<MotionSample> sample_motion(std::span<const geometry::PathPiece> path,
                                                      const FeedPlan& plan, double period);

}  // namespace batten::postproc
