// The way along one stretch in time: what its duration in velocity_profile stands for.
#pragma once

#include <vector>

#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {

// The speed changes evenly within a phase.
struct MotionPhase {
  double start = 0;         // s
  double duration = 0;      // s
  double way = 0;           // mm at its start
  double length = 0;        // mm
  double velocity = 0;      // mm/s at its start
  double acceleration = 0;  // mm/s^2
};

// A bend whose curvature takes its share of the acceleration has many phases; everything else
// three at the most.
class StretchMotion {
 public:
  // `v0` and `v1` are the speeds of its joints, as joint_velocities gives them.
  StretchMotion(const VelocityStretch& stretch, double v0, double v1, const ProfileRules& rules);

  // Seconds, as stretch_time says: the rest after a stop is part of it.
  [[nodiscard]] double duration() const { return duration_; }

  // Without the rest after a stop.
  [[nodiscard]] const std::vector<MotionPhase>& phases() const { return phases_; }

  // mm from the start of the stretch, at a time from 0 to the duration.
  [[nodiscard]] double way_at(double time) const;

  // Seconds at less than this speed, the rest after a stop included.
  [[nodiscard]] double time_below(double velocity) const;

 private:
  void add_phase(double way, double from_velocity, double to_velocity, double duration);
  void add_change(const VelocityStretch& stretch, double from_velocity, double to_velocity);

  std::vector<MotionPhase> phases_;
  double moving_ = 0;    // s: the sum of the phases
  double way_ = 0;       // mm: the same
  double duration_ = 0;  // s
  double length_ = 0;    // mm
};

}  // namespace batten::postproc
