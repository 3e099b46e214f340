// The fastest straight move between two speeds, in closed form.
#pragma once

#include <span>
#include <vector>

#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

struct StraightState {
  double distance = 0;      // mm from the start
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2
};

// With acceleration 0 at both ends: up to the peak, cruise, down, seven phases of constant jerk.
// Without a jerk limit phases of changing acceleration last no time.
struct StraightRun {
  LimitsAlong limits;
  double length = 0;  // mm
  double from = 0;    // mm/s
  double to = 0;      // mm/s
  double peak = 0;    // mm/s
  double time = 0;    // s

  // At a time between 0 and the whole. Not for a run that is too short for its speeds.
  [[nodiscard]] StraightState state_at(double at) const;
};

// Speeds above limits.speed count as that. Where the way is too short to change from the one speed
// to the other, the peak is the greater speed and the time that of their mean over the way.
//
// Requires length >= 0 and limits above 0; speed and at least one of the others finite.
[[nodiscard]] StraightRun straight_run(double length, double from_speed, double to_speed,
                                       const LimitsAlong& limits);

// Where the plan of a straight move has its nodes: seconds, rising, the end of the move included:
// where the jerk changes, `density` between those, and at `joints`, mm from the start.
[[nodiscard]] std::vector<double> node_times(const StraightRun& run, std::span<const double> joints,
                                             double density);

}  // namespace batten::postproc
