#include "postproc/machine/models/jerk_motion.h"

#include <algorithm>
#include <cmath>

#include "postproc/machine/models/speed_levels.h"

namespace batten::postproc {
namespace {

// Halvings that find a time to the last digit.
constexpr int kHalvings = 60;

double way_in(const JerkPhase& p, double t) {
  return t * (p.velocity + t * (p.acceleration / 2 + t * p.jerk / 6));
}

double velocity_in(const JerkPhase& p, double t) {
  return p.velocity + t * (p.acceleration + t * p.jerk / 2);
}

// The first time in [low, high] at which a rising function of time reaches `target`.
template <typename Function>
double time_of(const Function& value, double target, double low, double high) {
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    (value(middle) < target ? low : high) = middle;
  }
  return high;
}

}  // namespace

double s_ramp_time(double change, double acceleration, double jerk) {
  if (!std::isfinite(jerk)) return change / acceleration;
  if (change * jerk <= acceleration * acceleration) return 2 * std::sqrt(change / jerk);
  return change / acceleration + acceleration / jerk;
}

JerkMotion::JerkMotion(std::span<const VelocityStretch> chain, std::span<const double> velocities,
                       const ProfileRules& rules) {
  std::vector<SpeedLevel> levels = speed_levels(chain, velocities, rules);
  fit_s_curves(levels);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const SpeedLevel& level = levels[i];
    velocity_ = level.velocity;
    if (level.velocity > 0) add_cruise(level.way, level.velocity);
    if (i + 1 < levels.size()) {
      add_change(level.velocity, levels[i + 1].velocity, level.after.acceleration,
                 level.after.jerk);
    }
  }
}

void JerkMotion::add_phase(double duration, double acceleration, double jerk) {
  if (!(duration > 0)) return;
  const JerkPhase phase{duration_, duration, way_, velocity_, acceleration, jerk};
  phases_.push_back(phase);
  duration_ += duration;
  way_ += way_in(phase, duration);
  velocity_ = std::max(0.0, velocity_in(phase, duration));
}

void JerkMotion::add_cruise(double way, double velocity) { add_phase(way / velocity, 0, 0); }

void JerkMotion::add_change(double from, double to, double acceleration, double jerk) {
  const double change = std::abs(to - from);
  const double sign = to > from ? 1 : -1;
  if (!std::isfinite(jerk)) return add_phase(change / acceleration, sign * acceleration, 0);
  const bool reached = change * jerk > acceleration * acceleration;
  const double build_up = reached ? acceleration / jerk : std::sqrt(change / jerk);
  const double peak = jerk * build_up;
  const double held = reached ? change / acceleration - build_up : 0;
  add_phase(build_up, 0, sign * jerk);
  add_phase(held, sign * peak, 0);
  add_phase(build_up, sign * peak, -sign * jerk);
}

const JerkPhase& JerkMotion::phase_at(double time) const {
  const auto after = std::upper_bound(phases_.begin(), phases_.end(), time,
                                      [](double t, const JerkPhase& p) { return t < p.start; });
  return after == phases_.begin() ? *after : *(after - 1);
}

double JerkMotion::way_at(double time) const {
  if (phases_.empty() || time >= duration_) return way_;
  const JerkPhase& phase = phase_at(time);
  return std::min(way_, phase.way + way_in(phase, std::max(0.0, time - phase.start)));
}

double JerkMotion::velocity_at(double time) const {
  if (phases_.empty() || time >= duration_) return 0;
  const JerkPhase& phase = phase_at(time);
  return std::max(0.0, velocity_in(phase, std::max(0.0, time - phase.start)));
}

double JerkMotion::time_at(double way) const {
  if (phases_.empty() || way >= way_) return duration_;
  const auto after = std::upper_bound(phases_.begin(), phases_.end(), way,
                                      [](double w, const JerkPhase& p) { return w < p.way; });
  const JerkPhase& phase = after == phases_.begin() ? *after : *(after - 1);
  return phase.start +
         time_of([&](double t) { return way_in(phase, t); }, way - phase.way, 0, phase.duration);
}

double JerkMotion::time_below(double velocity, double from, double to) const {
  double time = 0;
  auto phase = std::upper_bound(phases_.begin(), phases_.end(), from,
                                [](double t, const JerkPhase& p) { return t < p.start; });
  if (phase != phases_.begin()) --phase;
  for (; phase != phases_.end() && phase->start < to; ++phase) {
    const double low = std::clamp(from - phase->start, 0.0, phase->duration);
    const double high = std::clamp(to - phase->start, 0.0, phase->duration);
    const double at_low = velocity_in(*phase, low);
    const double at_high = velocity_in(*phase, high);
    if (std::max(at_low, at_high) < velocity) {
      time += high - low;
    } else if (at_low < velocity) {
      time += time_of([&](double t) { return velocity_in(*phase, t); }, velocity, low, high) - low;
    } else if (at_high < velocity) {
      time +=
          high - time_of([&](double t) { return -velocity_in(*phase, t); }, -velocity, low, high);
    }
  }
  return time;
}

}  // namespace batten::postproc
