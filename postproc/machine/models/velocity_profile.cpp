#include "postproc/machine/models/velocity_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace batten::postproc {
namespace {

// Phases of even acceleration that stand for a change of speed on a bend. The acceleration
// falls to half of its first value there: 32 steps of it are 2 % each.
constexpr int kBendPhases = 32;

// Of the length of a stretch: less is what rounding leaves of nothing.
constexpr double kNoWay = 1e-12;

// Along a stretch, the way gained at full tangential acceleration is the difference of this
// potential (mm) of the speeds: v^2 / 2a on a straight line, and with the share of the bend
// ds = v dv / sqrt(a^2 - (k v^2)^2), hence asin(k v^2 / a) / 2k.
double potential(const VelocityStretch& s, double v) {
  if (s.curvature == 0) return v * v / (2 * s.acceleration);
  const double share = std::min(1.0, s.curvature * v * v / s.acceleration);
  return std::asin(share) / (2 * s.curvature);
}

double velocity_of_potential(const VelocityStretch& s, double potential) {
  if (s.curvature == 0) return std::sqrt(2 * s.acceleration * potential);
  const double angle = std::min(2 * s.curvature * potential, std::numbers::pi / 2);
  return std::sqrt(s.acceleration / s.curvature * std::sin(angle));
}

// The speed that `s` can reach over its length from the speed v.
double reached(const VelocityStretch& s, double v) {
  return velocity_of_potential(s, potential(s, v) + s.length);
}

}  // namespace

double speeding_up_way(const VelocityStretch& s, double v0, double v1) {
  return potential(s, v1) - potential(s, v0);
}

double speeding_up_time(const VelocityStretch& s, double v0, double v1) {
  if (s.curvature == 0) return (v1 - v0) / s.acceleration;
  // Gauss-Legendre with five points. The integrand 1 / sqrt(a^2 - (k v^2)^2) grows from 1 / a
  // to 2 / a where the bend takes sqrt(3)/2 of the acceleration, most of it near v1:
  // v = v1 - (v1 - v0) u^2 spreads that out (relative error 2e-5 at most).
  constexpr std::array<double, 5> kPoint = {-0.9061798459386640, -0.5384693101056831, 0,
                                            0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 5> kWeight = {0.2369268850561891, 0.4786286704993665,
                                             0.5688888888888889, 0.4786286704993665,
                                             0.2369268850561891};
  double sum = 0;
  for (std::size_t i = 0; i < kPoint.size(); ++i) {
    const double u = (1 + kPoint[i]) / 2;
    const double v = v1 - (v1 - v0) * u * u;
    const double normal = s.curvature * v * v;
    sum += kWeight[i] * u / std::sqrt(s.acceleration * s.acceleration - normal * normal);
  }
  return (v1 - v0) * sum;
}

double peak_velocity(const VelocityStretch& s, double v0, double v1) {
  const double peak_potential = (potential(s, v0) + potential(s, v1) + s.length) / 2;
  if (peak_potential >= potential(s, s.max_velocity)) return s.max_velocity;
  // Rounding must not put the peak below the ends.
  return std::max({velocity_of_potential(s, peak_potential), v0, v1});
}

bool is_even_ramp(const VelocityStretch& s, double v0, double v1, const ProfileRules& rules) {
  return s.runs_on && v1 > 0 && 2 * s.length < rules.ramp_time * (v0 + v1);
}

namespace {

// Seconds over the stretch, speeding up from v0 and slowing down to v1 as late as possible.
double trapezoid_time(const VelocityStretch& s, double v0, double v1) {
  if (v0 == s.max_velocity && v1 == s.max_velocity) return s.length / s.max_velocity;
  const double p0 = potential(s, v0);
  const double p1 = potential(s, v1);
  const double peak_potential = (p0 + p1 + s.length) / 2;
  const double limit_potential = potential(s, s.max_velocity);
  if (peak_potential < limit_potential) {
    const double peak = std::max({velocity_of_potential(s, peak_potential), v0, v1});
    return speeding_up_time(s, v0, peak) + speeding_up_time(s, v1, peak);
  }
  const double steady = s.length - (limit_potential - p0) - (limit_potential - p1);
  return speeding_up_time(s, v0, s.max_velocity) + speeding_up_time(s, v1, s.max_velocity) +
         steady / s.max_velocity;
}

// Greatest speed at each of the joints 0 to n, before accelerations are looked at.
std::vector<double> joint_limits(std::span<const VelocityStretch> chain) {
  const std::size_t n = chain.size();
  std::vector<double> limit(n + 1, 0.0);
  for (std::size_t i = 1; i < n; ++i) {
    limit[i] =
        std::min({chain[i - 1].max_velocity, chain[i - 1].exit_velocity, chain[i].max_velocity});
  }
  return limit;
}

// The window of a planner that sees `look_ahead` stretches beyond a joint. Bends are
// counted as if they took no share of the acceleration.
void limit_by_look_ahead(std::span<const VelocityStretch> chain, int look_ahead,
                         std::vector<double>& limit) {
  const std::size_t n = chain.size();
  const auto window = static_cast<std::size_t>(look_ahead);
  double square = 0;  // of the speed from which the stretches [i, i + window[ stop
  for (std::size_t i = 0; i < std::min(window, n); ++i) {
    square += 2 * chain[i].acceleration * chain[i].length;
  }
  for (std::size_t i = 0; i + window < n; ++i) {
    limit[i] = std::min(limit[i], std::sqrt(std::max(0.0, square)));
    square += 2 * chain[i + window].acceleration * chain[i + window].length -
              2 * chain[i].acceleration * chain[i].length;
  }
}

}  // namespace

double stretch_time(const VelocityStretch& s, double v0, double v1, const ProfileRules& rules) {
  const double moving =
      is_even_ramp(s, v0, v1, rules) ? 2 * s.length / (v0 + v1) : trapezoid_time(s, v0, v1);
  return v1 == 0 ? moving + rules.stop_time : moving;
}

std::vector<double> joint_velocities(std::span<const VelocityStretch> chain,
                                     const ProfileRules& rules) {
  const std::size_t n = chain.size();
  std::vector<double> v = joint_limits(chain);
  if (rules.look_ahead > 0) limit_by_look_ahead(chain, rules.look_ahead, v);
  // What is no faster than where it comes from is reached, whatever the length.
  for (std::size_t i = n; i-- > 0;) {
    if (v[i] > v[i + 1]) v[i] = std::min(v[i], reached(chain[i], v[i + 1]));
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (v[i + 1] > v[i]) v[i + 1] = std::min(v[i + 1], reached(chain[i], v[i]));
  }
  return v;
}

bool has_jerk_limit(std::span<const VelocityStretch> chain) {
  return std::ranges::any_of(chain, [](const VelocityStretch& s) { return s.jerk < kNoLimit; });
}

// --- the way along one stretch in time ------------------------------------------------------

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
  const MotionPhase& phase = *phase_at(phases_, time);
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
