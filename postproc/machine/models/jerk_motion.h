// The speed along a chain of stretches when the acceleration along the path cannot jump: the
// changes of speed that the profile without a limit on jerk makes become S-curves. Method:
// docs/algorithms/cycle_time.md.
#pragma once

#include <span>
#include <vector>

#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {

// The jerk is constant within a phase.
struct JerkPhase {
  double start = 0;         // s
  double duration = 0;      // s
  double way = 0;           // mm at its start
  double velocity = 0;      // mm/s at its start
  double acceleration = 0;  // mm/s^2 at its start
  double jerk = 0;          // mm/s^3
};

class JerkMotion {
 public:
  // `velocities` are those of joint_velocities(chain, rules). Of the stretches that a change of
  // speed runs over, the least jerk counts; where it runs through levels that it could not hold,
  // their mean. In bends a part of the jerk turns the acceleration.
  JerkMotion(std::span<const VelocityStretch> chain, std::span<const double> velocities,
             const ProfileRules& rules);

  // Phases that follow each other.
  explicit JerkMotion(std::vector<JerkPhase> phases);

  [[nodiscard]] double duration() const { return duration_; }  // s

  // mm from the start of the chain, and mm/s, at a time from 0 to the duration.
  [[nodiscard]] double way_at(double time) const;
  [[nodiscard]] double velocity_at(double time) const;

  // When the way is reached, s.
  [[nodiscard]] double time_at(double way) const;

  // Seconds at less than this speed (mm/s) between two times.
  [[nodiscard]] double time_below(double velocity, double from, double to) const;

 private:
  void add_phase(double duration, double acceleration, double jerk);
  void add_change(double from, double to, double acceleration, double jerk);

  std::vector<JerkPhase> phases_;
  double duration_ = 0;
  double way_ = 0;
  double velocity_ = 0;
};

// Seconds from rest to rest, with a limit on jerk or without.
[[nodiscard]] double profile_time(std::span<const VelocityStretch> chain,
                                  const ProfileRules& rules);

}  // namespace batten::postproc
