#include "postproc/machine/planner/feed_plan_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "postproc/machine/planner/feed_plan_path.h"
#include "postproc/machine/planner/feed_plan_problem.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;

// One interval of the plan, by the distance and time from its start.
class Interval {
 public:
  Interval(const FeedPlanNode& from, const FeedPlanNode& to)
      : length_(to.distance - from.distance),
        duration_(to.time - from.time),
        window_{from.speed * from.speed, 2 * from.acceleration, to.speed * to.speed,
                2 * to.acceleration} {}

  [[nodiscard]] double length() const { return length_; }

  [[nodiscard]] PlanState at(double s) const {
    if (window_[0] == 0) return power(window_[2], window_[3] / window_[2], s);
    if (window_[2] == 0) {
      PlanState back = power(window_[0], -window_[1] / window_[0], length_ - s);
      back.p = -back.p;
      return back;
    }
    return state_in(window_.data(), length_, s);
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
  [[nodiscard]] PlanState power(double q1, double slope, double s) const {
    const double m = slope * length_;
    if (!(s > 0)) return {0, m > 1.01 ? 0 : q1 / length_, 0};
    const double q = q1 * std::pow(s / length_, m);
    return {q, m * q / s, m * (m - 1) * q / (s * s)};
  }

  // Distance grows with this power of the time: 1 / (1 - m / 2).
  [[nodiscard]] double growth(double p1, double q1) const {
    return 1 / (1 - 0.5 * p1 * length_ / q1);
  }

  // From the start to s, by five-point Gauss-Legendre.
  [[nodiscard]] double seconds(double s) const {
    constexpr std::array<double, 5> kPlaces = {0.0469100770306680, 0.2307653449471585, 0.5,
                                               0.7692346550528415, 0.9530899229693320};
    constexpr std::array<double, 5> kWeights = {0.1184634425280945, 0.2393143352496832,
                                                0.2844444444444444, 0.2393143352496832,
                                                0.1184634425280945};
    double sum = 0;
    for (int i = 0; i < 5; ++i) sum += kWeights[i] / std::sqrt(at(s * kPlaces[i]).q);
    return s * sum;
  }

  double length_;
  double duration_;
  PlanWindow window_;  // q and p at both ends
};

// The parameter `s` mm after t0, by Newton steps.
double parameter_after(const PathPiece& piece, double t0, double t1, double length, double s) {
  double t = t0 + (t1 - t0) * s / length;
  for (int i = 0; i < 6; ++i) {
    const double missing = s - length_between(piece, t0, t);
    if (std::abs(missing) < 1e-12 * length) break;
    t = std::clamp(t + missing * (t1 - t0) / length, t0, t1);
  }
  return t;
}

MotionSample sample_at(const PathPiece& piece, double t, const PlanState& at, double time) {
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

}  // namespace

std::vector<MotionSample> sample_motion(std::span<const PathPiece> path, const FeedPlan& plan,
                                        double period) {
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
    const Interval interval(from, to);
    const double s = interval.distance_after(time - from.time);
    const double t1 = to.piece == from.piece ? to.t : 1;
    const double t = parameter_after(path[from.piece], from.t, t1, interval.length(), s);
    samples.push_back(sample_at(path[from.piece], t, interval.at(s), time));
  }
  return samples;
}

}  // namespace batten::postproc
