// The fastest run along a chain of stretches whose speeds and accelerations are limited,
// without a limit on jerk: one pass backward, one pass forward, then the time of each
// stretch. Method: docs/algorithms/cycle_time.md.
#pragma once

#include <limits>
#include <span>

namespace batten::postproc {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

// A part of the path with limits of its own. Where `curvature` is not 0, the bend takes its
// share of the acceleration: tangential^2 + (curvature * v^2)^2 <= acceleration^2.
struct VelocityStretch {
  double length = 0;                // mm, above 0
  double max_velocity = 0;          // mm/s, above 0; curvature * max_velocity^2 < acceleration
  double acceleration = 0;          // mm/s^2, above 0
  double curvature = 0;             // 1/mm
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

// Seconds from rest to rest.
[[nodiscard]] double profile_time(std::span<const VelocityStretch> chain,
                                  const ProfileRules& rules);

}  // namespace batten::postproc
