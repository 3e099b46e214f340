#include "postproc/machine/feed_plan_straight.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {
namespace {

// Seconds from rest to v: two jerk phases, and between them constant acceleration where the
// limit of it is met, that is above A^2 / J. Way v / 2 times this.
double ramp_time(double v, const LimitsAlong& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  if (std::isinf(j)) return v / a;
  return v * j <= a * a ? 2 * std::sqrt(v / j) : v / a + a / j;
}

// The speed whose two ramps are together `length` long: v ramp_time(v) = length.
double peak_speed(double length, const LimitsAlong& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  if (std::isinf(j)) return std::sqrt(length * a);
  const double without_constant = std::cbrt(0.25 * length * length * j);
  if (without_constant * j <= a * a) return without_constant;
  // v^2 / a + v a / j = length, and the root that does not cancel.
  const double half = 0.5 * a * a / j;
  return length * a / (half + std::sqrt(half * half + length * a));
}

// From rest, half of the move.
StraightState rising_state(const StraightMove& move, double time) {
  const double first = std::min(time, move.jerk_time);
  const double second = std::clamp(time - move.jerk_time, 0.0, move.acceleration_time);
  const double third =
      std::clamp(time - move.jerk_time - move.acceleration_time, 0.0, move.jerk_time);
  const double cruise = std::max(0.0, time - move.ramp_time());
  StraightState state;
  const auto run = [&state](double t, double jerk) {
    state.distance += t * (state.speed + t * (state.acceleration / 2 + t * jerk / 6));
    state.speed += t * (state.acceleration + t * jerk / 2);
    state.acceleration += t * jerk;
  };
  if (move.jerk_time > 0) run(first, move.jerk);
  if (!(move.jerk_time > 0)) state.acceleration = move.acceleration;
  run(second, 0);
  if (move.jerk_time > 0) run(third, -move.jerk);
  if (cruise > 0) state.acceleration = 0;
  run(cruise, 0);
  return state;
}

}  // namespace

StraightMove straight_move(double length, const LimitsAlong& limits) {
  StraightMove move;
  move.length = length;
  if (!(length > 0)) return move;
  move.speed = std::min(limits.speed, peak_speed(length, limits));
  move.jerk = limits.jerk;
  const double ramp = ramp_time(move.speed, limits);
  if (std::isinf(limits.jerk)) {
    move.acceleration_time = ramp;
    move.acceleration = limits.acceleration;
  } else {
    move.acceleration = std::min(limits.acceleration, std::sqrt(move.speed * limits.jerk));
    move.jerk_time = move.acceleration / limits.jerk;
    move.acceleration_time = std::max(0.0, ramp - 2 * move.jerk_time);
  }
  move.cruise_time = std::max(0.0, (length - move.speed * ramp) / move.speed);
  return move;
}

StraightState state_at(const StraightMove& move, double time) {
  if (2 * time <= move.time()) return rising_state(move, time);
  const StraightState back = rising_state(move, move.time() - time);
  return {move.length - back.distance, back.speed, -back.acceleration};
}

}  // namespace batten::postproc
