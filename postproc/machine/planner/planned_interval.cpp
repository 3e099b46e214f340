#include "postproc/machine/planner/planned_interval.h"

#include <algorithm>
#include <cmath>

#include "geometry/numeric/extrema.h"

namespace batten::postproc {

PlannedInterval::PlannedInterval(const FeedPlanNode& from, const FeedPlanNode& to)
    : length_(to.distance - from.distance),
      duration_(to.time - from.time),
      window_{from.speed * from.speed, 2 * from.acceleration, to.speed * to.speed,
              2 * to.acceleration} {}

PlannedState PlannedInterval::at(double s) const {
  if (window_[0] == 0) return power(window_[2], window_[3] / window_[2], s);
  if (window_[2] == 0) {
    PlannedState back = power(window_[0], -window_[1] / window_[0], length_ - s);
    back.p = -back.p;
    return back;
  }
  return state_in(window_.data(), length_, s);
}

double PlannedInterval::distance_after(double time) const {
  if (window_[0] == 0) return length_ * std::pow(time / duration_, growth(window_[3], window_[2]));
  if (window_[2] == 0) {
    const double left = std::max(0.0, 1 - time / duration_);
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

// q = q1 (s / length)^m with the slope at the far end that the plan has: m = p1 length / q1.
PlannedState PlannedInterval::power(double q1, double slope, double s) const {
  const double m = slope * length_;
  if (!(s > 0)) return {0, m > 1.01 ? 0 : q1 / length_, 0};
  const double q = q1 * std::pow(s / length_, m);
  return {q, m * q / s, m * (m - 1) * q / (s * s)};
}

// Distance grows with this power of the time: 1 / (1 - m / 2).
double PlannedInterval::growth(double p1, double q1) const {
  return 1 / (1 - 0.5 * p1 * length_ / q1);
}

// From the start to s.
double PlannedInterval::seconds(double s) const {
  return geometry::gauss5([&](double at_s) { return 1 / std::sqrt(at(at_s).q); }, 0, s);
}

}  // namespace batten::postproc
