// The fastest straight move from rest to rest, in closed form.
#pragma once

#include <array>

#include "postproc/machine/feed_plan_limits.h"

namespace batten::postproc {

// Seven phases of constant jerk: up, none, down, none (cruise), down, none, up. Without a jerk
// limit those of changing acceleration last no time.
struct StraightMove {
  double length = 0;             // mm
  double speed = 0;              // mm/s, the greatest
  double acceleration = 0;       // mm/s^2, the greatest
  double jerk = 0;               // mm/s^3
  double jerk_time = 0;          // s, of each of the four phases of changing acceleration
  double acceleration_time = 0;  // s, of each of the two of constant acceleration
  double cruise_time = 0;        // s

  [[nodiscard]] double ramp_time() const { return 2 * jerk_time + acceleration_time; }
  [[nodiscard]] double time() const { return 2 * ramp_time() + cruise_time; }
};

// Requires length >= 0 and limits above 0; speed and at least one of the others finite.
[[nodiscard]] StraightMove straight_move(double length, const LimitsAlong& limits);

struct StraightState {
  double distance = 0;      // mm from the start
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2
};

// At a time between 0 and move.time().
[[nodiscard]] StraightState state_at(const StraightMove& move, double time);

}  // namespace batten::postproc
