#include "postproc/machine/planner/feed_plan_straight.h"

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

// Speeds this close, as part of themselves, are the same: a few roundings of a step's terms.
constexpr double kSameSpeed = 1e-13;

// Way of a change of speed from v0 to v, and its derivative by v.
struct RampWay {
  double way;
  double rate;
};

RampWay ramp_way(double v0, double v, const LimitsAlong& limits) {
  const double change = v - v0;
  const double time = ramp_time(change, limits);
  const double a = limits.acceleration;
  const double mean = 0.5 * (v0 + v);
  if (!(change > 0)) return {0, 0.5 * time};
  // Where the acceleration limit is not met, T = 2 sqrt(change / J), and T' is T / (2 change).
  const bool limited = std::isinf(limits.jerk) || change * limits.jerk > a * a;
  return {mean * time, 0.5 * time + mean * (limited ? 1 / a : time / (2 * change))};
}

// `time` seconds after the start of the ramp from v0 to v1: the second half is the first one
// turned round.
StraightState state_in_ramp(double v0, double v1, double time, const LimitsAlong& limits) {
  const double whole = ramp_time(v1 - v0, limits);
  if (std::isinf(limits.jerk)) {
    const double a = limits.acceleration;
    return {time * (v0 + 0.5 * a * time), v0 + a * time, a};
  }
  if (2 * time > whole) {
    const StraightState back = state_in_ramp(0, v1 - v0, whole - time, limits);
    return {0.5 * (v0 + v1) * whole - v1 * (whole - time) + back.distance, v1 - back.speed,
            back.acceleration};
  }
  const double j = limits.jerk;
  const double t = std::min(time, std::min(limits.acceleration / j, 0.5 * whole));
  const double rest = time - t;
  const double a = j * t;
  const double v = v0 + 0.5 * a * t;
  return {t * (v0 + a * t / 6) + rest * (v + 0.5 * a * rest), v + a * rest, a};
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

StraightRun straight_run(double length, double from_speed, double to_speed,
                         const LimitsAlong& limits) {
  StraightRun run;
  run.length = length;
  run.from = std::min(from_speed, limits.speed);
  run.to = std::min(to_speed, limits.speed);
  double below = std::max(run.from, run.to);
  run.peak = below;
  if (!(length > 0)) return run;
  const auto excess = [&](double peak) {
    const RampWay up = ramp_way(run.from, peak, limits);
    const RampWay down = ramp_way(run.to, peak, limits);
    return RampWay{up.way + down.way - length, up.rate + down.rate};
  };
  if (excess(below).way > 0) {
    run.time = 2 * length / (run.from + run.to);
    return run;
  }
  // From rest the ramps to this speed less that of the faster end alone are that long.
  double above = std::min(limits.speed, below + peak_speed(length, limits));
  run.peak = above;
  constexpr int kMostSteps = 60;
  for (int i = 0; i < kMostSteps && above > below; ++i) {
    const RampWay at = excess(run.peak);
    if (at.way <= 0 && run.peak == limits.speed) break;
    const double step = at.way / at.rate;
    if (std::abs(step) <= kSameSpeed * run.peak) break;
    (at.way > 0 ? above : below) = run.peak;
    const double next = run.peak - step;
    run.peak = next > below && next < above ? next : 0.5 * (below + above);
  }
  const double cruise = std::max(0.0, -excess(run.peak).way) / run.peak;
  run.time = ramp_time(run.peak - run.from, limits) + ramp_time(run.peak - run.to, limits) + cruise;
  return run;
}

double StraightRun::speed_at(double way, const LimitsAlong& limits) const {
  const double up = ramp_way(from, peak, limits).way;
  const double down = ramp_way(to, peak, limits).way;
  if (way >= up && length - way >= down) return peak;
  const bool rising = way < up;
  const double start = rising ? from : to;
  const double distance = rising ? way : length - way;
  const double whole = ramp_time(peak - start, limits);
  double below = 0;
  double above = whole;
  constexpr int kHalvings = 50;  // all bits of the time
  double speed = start;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (below + above);
    const StraightState state = state_in_ramp(start, peak, middle, limits);
    speed = state.speed;
    (state.distance < distance ? below : above) = middle;
  }
  return speed;
}

RampTimes ramp_times(double speed, double peak, const LimitsAlong& limits) {
  const double whole = ramp_time(peak - speed, limits);
  if (std::isinf(limits.jerk)) return {whole, 0};
  return {whole, std::min(limits.acceleration / limits.jerk, 0.5 * whole)};
}

StraightState state_at(const StraightRun& run, double time, const LimitsAlong& limits) {
  const double up = ramp_time(run.peak - run.from, limits);
  const double down = ramp_time(run.peak - run.to, limits);
  if (time < up) return state_in_ramp(run.from, run.peak, time, limits);
  const double left = run.time - time;
  if (left < down) {
    const StraightState back = state_in_ramp(run.to, run.peak, left, limits);
    return {run.length - back.distance, back.speed, -back.acceleration};
  }
  return {0.5 * (run.from + run.peak) * up + run.peak * (time - up), run.peak, 0};
}

namespace {

// Times this close, as part of the whole, are the same: rounding of sums.
constexpr double kSamePart = 1e-12;

double time_at(const StraightMove& move, double distance) {
  double below = 0;
  double above = move.time();
  while (true) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) return middle;
    (state_at(move, middle).distance < distance ? below : above) = middle;
  }
}

double time_at(const StraightRun& run, const LimitsAlong& limits, double distance) {
  double below = 0;
  double above = run.time;
  while (true) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) return middle;
    (state_at(run, middle, limits).distance < distance ? below : above) = middle;
  }
}

}  // namespace

// From rest to the end of the first phase, and in the last, the plan's intervals are exact; but
// after an end of a piece there they are not, and must be short against the time from rest.
std::vector<double> node_times(const StraightMove& move, const std::vector<double>& ends,
                               double density) {
  const bool jerk = move.jerk_time > 0;
  const double first = jerk ? move.jerk_time : move.acceleration_time;
  const double inner[] = {jerk ? move.acceleration_time : 0, jerk ? move.jerk_time : 0,
                          move.cruise_time, jerk ? move.jerk_time : 0,
                          jerk ? move.acceleration_time : 0};
  const int parts = std::max(1, static_cast<int>(std::ceil(density)));
  std::vector<double> times;
  double start = first;
  times.push_back(start);
  for (const double phase : inner) {
    const int count = phase > kSamePart * move.time() ? parts : 0;
    for (int i = 1; i <= count; ++i) times.push_back(start + phase * i / count);
    start += phase;
  }
  times.push_back(move.time());
  double nearest_start = first;
  double nearest_end = first;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
    const double time = time_at(move, ends[i]);
    times.push_back(time);
    nearest_start = std::min(nearest_start, time);
    nearest_end = std::min(nearest_end, move.time() - time);
  }
  const double growth = 1 + 1 / density;
  for (double t = nearest_start * growth; t < first; t *= growth) times.push_back(t);
  for (double t = nearest_end * growth; t < first; t *= growth) times.push_back(move.time() - t);
  std::sort(times.begin(), times.end());
  return times;
}

// Times of nodes of a run between two speeds. Near a slow end, and after the end of a piece, nodes
// lie in geometric progression: there the plan's intervals are exact only where they are short.
std::vector<double> node_times(const StraightRun& run, const LimitsAlong& limits,
                               const std::vector<double>& ends, double density) {
  const double growth = 1 + 1 / density;
  const int parts = std::max(1, static_cast<int>(std::ceil(density)));
  std::vector<double> joints = {0, run.time};
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) joints.push_back(time_at(run, limits, ends[i]));
  std::vector<double> times = joints;
  const auto add_ramp = [&](double speed, double direction) {
    const RampTimes ramp = ramp_times(speed, run.peak, limits);
    const double origin = direction > 0 ? 0 : run.time;
    const auto add = [&](double time) { times.push_back(origin + direction * time); };
    const auto add_evenly = [&](double from, double to) {
      if (!(to - from > kSamePart * run.time)) return;
      for (int i = 1; i <= parts; ++i) add(from + (to - from) * i / parts);
    };
    double nearest = speed > 0 ? std::sqrt(speed / limits.jerk) / density : ramp.growing;
    for (const double joint : joints) {
      const double time = direction * (joint - origin);
      if (time > 0) nearest = std::min(nearest, time);
    }
    for (double time = nearest; time < ramp.growing; time *= growth) add(time);
    if (ramp.growing > 0) add(ramp.growing);
    add_evenly(ramp.growing, ramp.whole - ramp.growing);
    add_evenly(ramp.whole - ramp.growing, ramp.whole);
  };
  add_ramp(run.from, 1);
  add_ramp(run.to, -1);
  std::sort(times.begin(), times.end());
  const auto same = [&](double a, double b) { return b - a <= kSamePart * run.time; };
  times.erase(std::unique(times.begin(), times.end(), same), times.end());
  times.erase(times.begin());
  times.back() = run.time;
  return times;
}

}  // namespace batten::postproc
