// Machines for tests: limits of X, Y and Z alike, one of each model, what a feed plan may ask.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "postproc/machine/machine.h"
#include "postproc/machine/planner/feed_plan_path.h"

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

// The limits of X, Y and Z, those of the path, and the servo period. `feed` (mm/s): as programmed,
// where it is less than what the machine takes. Rotary axes are not part of such a path.
inline KinematicPathLimits path_limits_of(const Machine& machine, double feed = Machine::kNone) {
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

// 200 mm/s, rapids 300 mm/s, 1000 mm/s2, blocks of a millisecond and more.
inline Machine machine_of(ControllerModel model) {
  Machine m;
  m.name = "test";
  m.model = model;
  set_max_velocity(m, 200);
  set_rapid_velocity(m, 300);
  set_max_acceleration(m, 1000);
  m.block_period = 0.001;
  m.look_ahead = 1000;
  m.blend_tolerance = 0.01;
  return m;
}

inline constexpr ControllerModel kModels[] = {ControllerModel::kLookAhead,
                                              ControllerModel::kLinuxcnc, ControllerModel::kGrbl};

// For INSTANTIATE_TEST_SUITE_P.
inline std::string model_name(const testing::TestParamInfo<ControllerModel>& test) {
  return test.param == ControllerModel::kLookAhead  ? "LookAhead"
         : test.param == ControllerModel::kLinuxcnc ? "Linuxcnc"
                                                    : "Grbl";
}

// LinuxCNC ends a stop with a whole period; half of it is the model's mean.
inline double stop_loss(const Machine& m) {
  return m.model == ControllerModel::kLinuxcnc ? m.block_period / 2 : 0;
}

}  // namespace batten::postproc
