// The fastest run along a chain of stretches whose speeds and accelerations are limited:
// one pass backward, one pass forward, then the time of each stretch. A limit on jerk comes on
// top of it. Method: docs/algorithms/cycle_time.md.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

namespace batten::postproc {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// A part of the path with limits of its own. Where `curvature` is not 0, the bend takes its
// share of the acceleration: tangential^2 + (curvature * v^2)^2 <= acceleration^2.
struct VelocityStretch {
  double length = 0;                // mm, above 0
  double max_velocity = 0;          // mm/s, above 0; curvature * max_velocity^2 < acceleration
  double acceleration = 0;          // mm/s^2, above 0
  double curvature = 0;             // 1/mm
  double jerk = kNoLimit;           // mm/s^3 along the path; no limit unless the control has one
  double exit_velocity = kNoLimit;  // mm/s at its end; 0: the path stops there
  bool runs_on = true;              // a short stretch may take one constant acceleration
};

struct ProfileRules {
  // A joint is passed no faster than the path can stop within the next `look_ahead`
  // stretches. 0: the whole chain is seen.
  int look_ahead = 0;
  // A stretch that runs on and takes less than this (s) does not speed up and slow down
  // within itself: its speed changes evenly from the one end to the other. 0: never.
  double ramp_time = 0;
  double stop_time = 0;  // s lost at each stop, the one at the end included
};

// Is there a stretch with a limit on jerk? Its changes of speed are S-curves then (jerk_motion.h).
[[nodiscard]] bool has_jerk_limit(std::span<const VelocityStretch> chain);

// mm/s at the joints 0 to n of the fastest run from rest to rest; n + 1 of them.
[[nodiscard]] std::vector<double> joint_velocities(std::span<const VelocityStretch> chain,
                                                   const ProfileRules& rules);

// Seconds over one stretch between the speeds of its joints, with the loss of a stop at its end.
[[nodiscard]] double stretch_time(const VelocityStretch& stretch, double v0, double v1,
                                  const ProfileRules& rules);

// --- for one stretch, as its time is computed ---------------------------------------------

// Does the speed change evenly from the one end to the other (ProfileRules::ramp_time)?
[[nodiscard]] bool is_even_ramp(const VelocityStretch& stretch, double v0, double v1,
                                const ProfileRules& rules);

// The greatest speed between its ends (mm/s).
[[nodiscard]] double peak_velocity(const VelocityStretch& stretch, double v0, double v1);

// mm between two speeds v0 <= v1 at full tangential acceleration.
[[nodiscard]] double speeding_up_way(const VelocityStretch& stretch, double v0, double v1);

// Seconds for the same.
[[nodiscard]] double speeding_up_time(const VelocityStretch& stretch, double v0, double v1);

// --- the way along one stretch in time: which its duration is of ------------------------

// The speed changes evenly within a phase.
struct MotionPhase {
  double start = 0;         // s
  double duration = 0;      // s
  double way = 0;           // mm at its start
  double length = 0;        // mm
  double velocity = 0;      // mm/s at its start
  double acceleration = 0;  // mm/s^2
};

// The phase in which `member` (its time or way at the start) comes up to `value`; one is there.
template <typename Phase>
[[nodiscard]] auto phase_at(const std::vector<Phase>& phases, double value,
                            double Phase::*member = &Phase::start) {
  const auto after = std::ranges::upper_bound(phases, value, {}, member);
  return after == phases.begin() ? after : after - 1;
}

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
