#include "postproc/machine/machine_path_limits.h"

#include <algorithm>

namespace batten::postproc {

KinematicPathLimits path_limits_of(const Machine& machine, double feed) {
  KinematicPathLimits limits;
  limits.feed = std::min(feed, machine.path_feed);
  for (std::size_t i = 0; i < kLinearAxes; ++i) {
    const AxisLimits& axis = machine.axes[i];
    const auto at = static_cast<Eigen::Index>(i);
    limits.speed[at] = axis.velocity;
    limits.acceleration[at] = axis.acceleration;
    limits.jerk[at] = axis.jerk;
  }
  limits.tangential_acceleration = machine.path_acceleration;
  limits.tangential_jerk = machine.path_jerk;
  limits.period = machine.servo_period;
  return limits;
}

}  // namespace batten::postproc
