// Machines whose X, Y and Z are alike.
#pragma once

#include "postproc/machine/machine.h"

namespace batten::postproc {

inline void set_xyz(Machine& machine, double AxisLimits::*limit, double value) {
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) machine.axis(axis).*limit = value;
}

inline void set_max_velocity(Machine& machine, double mm_per_s) {
  set_xyz(machine, &AxisLimits::velocity, mm_per_s);
}
inline void set_max_acceleration(Machine& machine, double mm_per_s2) {
  set_xyz(machine, &AxisLimits::acceleration, mm_per_s2);
}
inline void set_max_jerk(Machine& machine, double mm_per_s3) {
  set_xyz(machine, &AxisLimits::jerk, mm_per_s3);
}
inline void set_rapid_velocity(Machine& machine, double mm_per_s) {
  set_xyz(machine, &AxisLimits::rapid_velocity, mm_per_s);
}

}  // namespace batten::postproc
