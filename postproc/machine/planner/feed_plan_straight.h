// The fastest straight move from rest to rest, in closed form.
#pragma once

#include <array>
#include <vector>

#include "postproc/machine/planner/feed_plan_path.h"

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

// A straight move between two speeds, with acceleration 0 at both ends: up to the peak, cruise,
// down. Speeds above limits.speed count as that. Between rests it is straight_move().
struct StraightRun {
  double length = 0;  // mm
  double from = 0;    // mm/s
  double to = 0;      // mm/s
  double peak = 0;    // mm/s
  double time = 0;    // s

  // mm/s, so many mm from the start.
  [[nodiscard]] double speed_at(double way, const LimitsAlong& limits) const;
};

// At a time between 0 and run.time. Not for a run that is too short for its speeds.
[[nodiscard]] StraightState state_at(const StraightRun& run, double time,
                                     const LimitsAlong& limits);

// Seconds of one of its ramps, from or to that speed, and of the first phase of it.
struct RampTimes {
  double whole = 0;
  double growing = 0;  // in which the acceleration grows; as long as the one in which it falls
};
[[nodiscard]] RampTimes ramp_times(double speed, double peak, const LimitsAlong& limits);

// Where the way is too short to change from the one speed to the other, the peak is the greater
// speed and the time that of their mean over the way. Requires limits as for straight_move().
[[nodiscard]] StraightRun straight_run(double length, double from_speed, double to_speed,
                                       const LimitsAlong& limits);

// Where the plan of a straight move has its nodes.

// Seconds, rising, the end of the move included: where the jerk changes, `density` places between
// those, and at `ends`, the distances of the ends of its pieces in mm.
[[nodiscard]] std::vector<double> node_times(const StraightMove& move,
                                             const std::vector<double>& ends, double density);
[[nodiscard]] std::vector<double> node_times(const StraightRun& run, const LimitsAlong& limits,
                                             const std::vector<double>& ends, double density);

}  // namespace batten::postproc
