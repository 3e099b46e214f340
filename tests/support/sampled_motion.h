// A feed plan in time: what its nodes say about the motion between them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/numeric/extrema.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"

namespace batten::postproc {

// Seconds.
inline double planned_time(std::span<const geometry::PathPiece> path,
                           const KinematicPathLimits& limits, const PlanEnds& ends = {},
                           double density = kPlanDensity) {
  return plan_feed(path, limits, ends, density).time;
}

// A feed plan in time, as a control would send it to the axes.
struct MotionSample {
  double time = 0;                     // s
  double speed = 0;                    // mm/s along the path
  double tangential_acceleration = 0;  // mm/s^2
  double tangential_jerk = 0;          // mm/s^3
  geometry::Point3 position;
  geometry::Vector3 velocity;      // mm/s
  geometry::Vector3 acceleration;  // mm/s^2
  geometry::Vector3 jerk;          // mm/s^3
};

// q = (ds/dt)^2 and its first two derivatives by the distance s.
struct PlannedState {
  double q = 0;
  double p = 0;
  double r = 0;
};

// One interval of the plan, by the distance and time from its start.
class PlannedInterval {
 public:
  PlannedInterval(const FeedPlanNode& from, const FeedPlanNode& to)
      : length_(to.distance - from.distance),
        duration_(to.time - from.time),
        window_{from.speed * from.speed, 2 * from.acceleration, to.speed * to.speed,
                2 * to.acceleration} {}

  [[nodiscard]] double length() const { return length_; }

  [[nodiscard]] PlannedState at(double s) const {
    if (window_[0] == 0) return power(window_[2], window_[3] / window_[2], s);
    if (window_[2] == 0) {
      PlannedState back = power(window_[0], -window_[1] / window_[0], length_ - s);
      back.p = -back.p;
      return back;
    }
    return cubic(s);
  }

  // The distance `time` seconds after the start.
  [[nodiscard]] double distance_after(double time) const {
    if (window_[0] == 0)
      return length_ * std::pow(time / duration_, growth(window_[3], window_[2]));
    if (window_[2] == 0) {
      const double left = 1 - time / duration_;
      return length_ * (1 - std::pow(left, growth(-window_[1], window_[0])));
    }
    // Time by Simpson's rule in the plan, here by a finer one: stretched to the plan's.
    const double scale = seconds(length_) / duration_;
    double s = length_ * time / duration_;
    for (int i = 0; i < 20; ++i) {
      const double change = (time * scale - seconds(s)) * std::sqrt(at(s).q);
      s = std::clamp(s + change, 0.0, length_);
      if (std::abs(change) < 1e-13 * length_) break;
    }
    return s;
  }

 private:
  // q = q1 (s / length)^m with the slope at the far end that the plan has: m = p1 length / q1.
  [[nodiscard]] PlannedState power(double q1, double slope, double s) const {
    const double m = slope * length_;
    if (!(s > 0)) return {0, m > 1.01 ? 0 : q1 / length_, 0};
    const double q = q1 * std::pow(s / length_, m);
    return {q, m * q / s, m * (m - 1) * q / (s * s)};
  }

  [[nodiscard]] PlannedState cubic(double s) const {
    const auto& [q0, p0, q1, p1] = window_;
    const double rise = (q1 - q0) / length_;
    const double r0 = (6 * rise - 4 * p0 - 2 * p1) / length_;
    const double third = 6 * (p0 + p1 - 2 * rise) / (length_ * length_);
    return {q0 + s * (p0 + s * (r0 / 2 + s * third / 6)), p0 + s * (r0 + s * third / 2),
            r0 + s * third};
  }

  // Distance grows with this power of the time: 1 / (1 - m / 2).
  [[nodiscard]] double growth(double p1, double q1) const {
    return 1 / (1 - 0.5 * p1 * length_ / q1);
  }

  // From the start to s.
  [[nodiscard]] double seconds(double s) const {
    return geometry::gauss5([&](double at_s) { return 1 / std::sqrt(at(at_s).q); }, 0, s);
  }

  double length_;
  double duration_;
  std::array<double, 4> window_;  // q and p at both ends
};

inline MotionSample sample_at(const geometry::PathPiece& piece, double t, const PlannedState& at,
                              double time) {
  const LengthDerivatives x = derivatives_by_length(piece, t);
  MotionSample sample;
  sample.time = time;
  sample.speed = std::sqrt(at.q);
  sample.tangential_acceleration = at.p / 2;
  sample.tangential_jerk = at.r / 2 * sample.speed;
  sample.position = geometry::point_at(piece, t);
  sample.velocity = x.first * sample.speed;
  sample.acceleration = x.second * at.q + x.first * (at.p / 2);
  sample.jerk = (x.third * at.q + x.second * (1.5 * at.p) + x.first * (0.5 * at.r)) * sample.speed;
  return sample;
}

// The state every `period` seconds from 0 on, the end of the plan not included. `path` is the one
// that was planned.
inline std::vector<MotionSample> sample_motion(std::span<const geometry::PathPiece> path,
                                               const FeedPlan& plan, double period) {
  if (!(period > 0)) {
    throw std::invalid_argument("sample_motion: period " + std::to_string(period) +
                                " s, expected above 0");
  }
  std::vector<MotionSample> samples;
  std::size_t k = 0;
  for (std::size_t i = 0; !plan.nodes.empty(); ++i) {
    const double time = static_cast<double>(i) * period;
    while (k + 1 < plan.nodes.size() && plan.nodes[k + 1].time <= time) ++k;
    if (k + 1 >= plan.nodes.size()) break;
    const FeedPlanNode& from = plan.nodes[k];
    const FeedPlanNode& to = plan.nodes[k + 1];
    const PlannedInterval interval(from, to);
    const double s = interval.distance_after(time - from.time);
    const double t1 = to.piece == from.piece ? to.t : 1;
    const double t = parameter_after(path[from.piece], from.t, t1, interval.length(), s);
    samples.push_back(sample_at(path[from.piece], t, interval.at(s), time));
  }
  return samples;
}

}  // namespace batten::postproc
