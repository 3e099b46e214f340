#include "postproc/machine/planner/feed_plan_limits.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace batten::postproc {
namespace {

using geometry::Vector3;

void require_positive(double value, const char* name) {
  if (value > 0) return;
  throw std::invalid_argument("KinematicPathLimits: " + std::string(name) + " is " +
                              std::to_string(value) + ", expected above 0");
}

void require_not_negative(double value, const char* name) {
  if (value >= 0) return;
  throw std::invalid_argument("KinematicPathLimits: " + std::string(name) + " is " +
                              std::to_string(value) + ", expected 0 or more");
}

// The length along `direction` at which the first axis meets its limit.
double along(const Vector3& direction, const Vector3& limit) {
  double least = KinematicPathLimits::kNone;
  for (int axis = 0; axis < 3; ++axis) {
    const double part = std::abs(direction[axis]);
    if (part > 0) least = std::min(least, limit[axis] / part);
  }
  return least;
}

}  // namespace

void require_sound(const KinematicPathLimits& limits) {
  require_positive(limits.feed, "feed");
  for (int axis = 0; axis < 3; ++axis) {
    require_positive(limits.speed[axis], "speed");
    require_positive(limits.acceleration[axis], "acceleration");
    require_positive(limits.jerk[axis], "jerk");
    require_not_negative(limits.speed_step[axis], "speed_step");
  }
  require_positive(limits.tangential_acceleration, "tangential_acceleration");
  require_positive(limits.tangential_jerk, "tangential_jerk");
  require_positive(limits.normal_acceleration, "normal_acceleration");
  require_not_negative(limits.period, "period");
  if (std::isinf(limits.feed) && std::isinf(limits.speed.maxCoeff())) {
    throw std::invalid_argument("KinematicPathLimits: neither a feed nor a speed for every axis");
  }
}

LimitsAlong limits_along(const Vector3& direction, const KinematicPathLimits& limits) {
  return {std::min(limits.feed, along(direction, limits.speed)),
          std::min(limits.tangential_acceleration, along(direction, limits.acceleration)),
          std::min(limits.tangential_jerk, along(direction, limits.jerk))};
}

}  // namespace batten::postproc
