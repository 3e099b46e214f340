#include "postproc/machine/models/stretch_motion.h"

#include <algorithm>
#include <cmath>

namespace batten::postproc {
namespace {

// Phases of even acceleration that stand for a change of speed on a bend. The acceleration
// falls to half of its first value there: 32 steps of it are 2 % each.
constexpr int kBendPhases = 32;

// Of the length of a stretch: less is what rounding leaves of nothing.
constexpr double kNoWay = 1e-12;

}  // namespace

StretchMotion::StretchMotion(const VelocityStretch& stretch, double v0, double v1,
                             const ProfileRules& rules)
    : duration_(stretch_time(stretch, v0, v1, rules)), length_(stretch.length) {
  if (is_even_ramp(stretch, v0, v1, rules)) {
    add_phase(stretch.length, v0, v1, 2 * stretch.length / (v0 + v1));
    return;
  }
  const double peak = peak_velocity(stretch, v0, v1);
  add_change(stretch, v0, peak);
  const double steady =
      stretch.length - speeding_up_way(stretch, v0, peak) - speeding_up_way(stretch, v1, peak);
  add_phase(steady, peak, peak, steady / peak);
  add_change(stretch, peak, v1);
}

void StretchMotion::add_phase(double way, double from_velocity, double to_velocity,
                              double duration) {
  if (!(way > kNoWay * length_)) return;
  phases_.push_back({.start = moving_,
                     .duration = duration,
                     .way = way_,
                     .length = way,
                     .velocity = from_velocity,
                     .acceleration = (to_velocity - from_velocity) / duration});
  moving_ += duration;
  way_ += way;
}

// On a bend the speeds of the phases lie closest where the acceleration falls fastest, at the
// greater speed; their durations are scaled so that the sum is that of the profile.
void StretchMotion::add_change(const VelocityStretch& stretch, double from_velocity,
                               double to_velocity) {
  const double slow = std::min(from_velocity, to_velocity);
  const double fast = std::max(from_velocity, to_velocity);
  if (!(fast > slow)) return;
  const double duration = speeding_up_time(stretch, slow, fast);
  const int parts = stretch.curvature == 0 ? 1 : kBendPhases;
  const auto velocity = [&](int i) {
    const double left = 1 - double(i) / parts;
    return fast - (fast - slow) * left * left;
  };
  double sum = 0;
  for (int i = 0; i < parts; ++i) {
    sum += 2 * speeding_up_way(stretch, velocity(i), velocity(i + 1)) /
           (velocity(i) + velocity(i + 1));
  }
  for (int i = 0; i < parts; ++i) {
    const int k = to_velocity > from_velocity ? i : parts - 1 - i;
    const double way = speeding_up_way(stretch, velocity(k), velocity(k + 1));
    const double part = 2 * way / (velocity(k) + velocity(k + 1)) * (duration / sum);
    const bool rises = to_velocity > from_velocity;
    add_phase(way, velocity(rises ? k : k + 1), velocity(rises ? k + 1 : k), part);
  }
}

double StretchMotion::way_at(double time) const {
  if (phases_.empty() || time >= moving_) return length_;
  const auto after = std::upper_bound(phases_.begin(), phases_.end(), time,
                                      [](double t, const MotionPhase& p) { return t < p.start; });
  const MotionPhase& phase = after == phases_.begin() ? *after : *(after - 1);
  // On a bend the duration is that of the profile, the way that of even acceleration: they differ
  // by the error of the profile's integral, which no place is to show as a step.
  const auto way_after = [&](double t) {
    return t * (phase.velocity + phase.acceleration * t / 2);
  };
  const double part = way_after(std::max(0.0, time - phase.start)) / way_after(phase.duration);
  return std::min(phase.way + part * phase.length, length_);
}

double StretchMotion::time_below(double velocity) const {
  double time = duration_ - moving_;
  for (const MotionPhase& p : phases_) {
    const double end = p.velocity + p.acceleration * p.duration;
    const double slow = std::min(p.velocity, end);
    const double fast = std::max(p.velocity, end);
    if (velocity >= fast) {
      time += p.duration;
    } else if (velocity > slow) {
      time += p.duration * (velocity - slow) / (fast - slow);
    }
  }
  return time;
}

}  // namespace batten::postproc
