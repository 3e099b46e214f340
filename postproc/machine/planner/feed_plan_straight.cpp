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

StraightRun straight_run(double length, double from_speed, double to_speed,
                         const LimitsAlong& limits) {
  StraightRun run{limits, length, std::min(from_speed, limits.speed),
                  std::min(to_speed, limits.speed)};
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

StraightState StraightRun::state_at(double at) const {
  const double up = ramp_time(peak - from, limits);
  const double down = ramp_time(peak - to, limits);
  if (at < up) return state_in_ramp(from, peak, at, limits);
  const double left = time - at;
  if (left < down) {
    const StraightState back = state_in_ramp(to, peak, left, limits);
    return {length - back.distance, back.speed, -back.acceleration};
  }
  return {0.5 * (from + peak) * up + peak * (at - up), peak, 0};
}

namespace {

// Times this close, as part of the whole, are the same: rounding of sums.
constexpr double kSamePart = 1e-12;

double time_at(const StraightRun& run, double distance) {
  double below = 0;
  double above = run.time;
  while (true) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) return middle;
    (run.state_at(middle).distance < distance ? below : above) = middle;
  }
}

}  // namespace

// Near a slow end, and after a joint, nodes lie in geometric progression: there the plan's
// intervals are exact only where they are short.
std::vector<double> node_times(const StraightRun& run, std::span<const double> joints,
                               double density) {
  std::vector<double> times = {0, run.time};
  for (const double joint : joints) times.push_back(time_at(run, joint));
  const std::vector<double> fixed = times;
  const int parts = std::max(1, static_cast<int>(std::ceil(density)));
  const auto add_ramp = [&](double speed, double direction) {
    const double whole = ramp_time(run.peak - speed, run.limits);
    // In which the acceleration grows; as long as the phase in which it falls.
    const double growing = std::isinf(run.limits.jerk)
                               ? 0
                               : std::min(run.limits.acceleration / run.limits.jerk, 0.5 * whole);
    const double origin = direction > 0 ? 0 : run.time;
    double nearest = speed > 0 ? std::sqrt(speed / run.limits.jerk) / density : growing;
    for (const double time : fixed) {
      const double after = direction * (time - origin);
      if (after > 0) nearest = std::min(nearest, after);
    }
    std::vector<double> added;
    for (double t = nearest; t < growing; t *= 1 + 1 / density) added.push_back(t);
    for (int i = 0; i <= parts; ++i) {
      added.push_back(growing + (whole - 2 * growing) * i / parts);
      added.push_back(whole - growing + growing * i / parts);
    }
    for (const double t : added) times.push_back(origin + direction * t);
  };
  add_ramp(run.from, 1);
  add_ramp(run.to, -1);
  std::ranges::sort(times);
  const auto same = [&](double a, double b) { return b - a <= kSamePart * run.time; };
  times.erase(std::unique(times.begin(), times.end(), same), times.end());
  times.erase(times.begin());
  times.back() = run.time;
  return times;
}

}  // namespace batten::postproc
