#include "postproc/machine/planner/s_curve.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace batten::postproc {
namespace {

double allowed_velocity(double curvature, const SCurveLimits& limits) {
  if (curvature <= 0) return limits.velocity;
  return std::min(limits.velocity, std::sqrt(limits.acceleration / curvature));
}

// Neighbouring samples with one allowed speed, by their numbers.
struct Level {
  double velocity = 0;
  std::size_t first = 0;
  std::size_t last = 0;

  [[nodiscard]] std::size_t middle() const { return (first + last) / 2; }
};

std::vector<Level> levels_of(std::span<const geometry::ParameterSample> samples,
                             const SCurveLimits& limits) {
  std::vector<Level> levels;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double v = allowed_velocity(samples[i].curvature, limits);
    if (!levels.empty() && levels.back().velocity == v) {
      levels.back().last = i;
    } else {
      levels.push_back({v, i, i});
    }
  }
  return levels;
}

bool is_extremum(const Level& before, const Level& level, const Level& after) {
  return (level.velocity > before.velocity) == (level.velocity > after.velocity);
}

// Distance over which the speed changes from one to the other, without acceleration at both.
double s_curve_distance(double v0, double v1, const SCurveLimits& limits) {
  return 0.5 * (v0 + v1) * s_curve_change(std::abs(v1 - v0), limits);
}

// The greatest speed, up to `high`, that an S-curve from `low` reaches in `distance`.
double reachable(double low, double high, double distance, const SCurveLimits& limits) {
  if (s_curve_distance(low, high, limits) <= distance) return high;
  double below = low;
  double above = high;
  while (true) {
    const double middle = 0.5 * (below + above);
    if (middle <= below || middle >= above) return below;
    (s_curve_distance(low, middle, limits) <= distance ? below : above) = middle;
  }
}

void lower(SCurveNode& node, const SCurveNode& neighbour, const SCurveLimits& limits) {
  if (node.velocity <= neighbour.velocity) return;
  const double distance = std::abs(node.distance - neighbour.distance);
  node.velocity = reachable(neighbour.velocity, node.velocity, distance, limits);
}

}  // namespace

double s_curve_change(double change, const SCurveLimits& limits) {
  const double a = limits.acceleration;
  const double j = limits.jerk;
  return change <= a * a / j ? 2 * std::sqrt(change / j) : change / a + a / j;
}

std::vector<SCurveNode> s_curve_nodes(std::span<const geometry::ParameterSample> samples,
                                      const SCurveLimits& limits) {
  const std::vector<Level> levels = levels_of(samples, limits);
  if (levels.empty()) return {};
  std::vector<SCurveNode> nodes = {{samples.front().distance, levels.front().velocity}};
  for (std::size_t i = 1; i + 1 < levels.size(); ++i) {
    if (!is_extremum(levels[i - 1], levels[i], levels[i + 1])) continue;
    nodes.push_back({samples[levels[i].middle()].distance, levels[i].velocity});
  }
  nodes.push_back({samples.back().distance, levels.back().velocity});
  for (std::size_t i = 1; i < nodes.size(); ++i) lower(nodes[i], nodes[i - 1], limits);
  for (std::size_t i = nodes.size() - 1; i > 0; --i) lower(nodes[i - 1], nodes[i], limits);
  return nodes;
}

namespace {

// A change of speed from 0 to 1 in the time from 0 to 1, without acceleration at both ends: jerk in
// the first and last part `ramp` (0 to 1/2) of the time, even acceleration between.
class UnitChange {
 public:
  explicit UnitChange(double ramp) : ramp_(ramp) {}

  [[nodiscard]] double speed(double t) const {
    if (t > 0.5) return 1 - speed(1 - t);
    if (t < ramp_) return t * t / (2 * ramp_ * (1 - ramp_));
    return (t - ramp_ / 2) / (1 - ramp_);
  }

  [[nodiscard]] double distance(double t) const {
    if (t > 0.5) return t - 0.5 + distance(1 - t);
    if (t < ramp_) return t * t * t / (6 * ramp_ * (1 - ramp_));
    const double even = t - ramp_ / 2;
    return (even * even + ramp_ * ramp_ / 12) / (2 * (1 - ramp_));
  }

 private:
  double ramp_;
};

// mm/s, so far (mm) after `from`; `distance` is at most that of `to`.
double speed_between(const SCurveNode& from, const SCurveNode& to, double distance,
                     const SCurveLimits& limits) {
  const double change = to.velocity - from.velocity;
  if (change == 0) return from.velocity;
  const double ramp =
      std::min(0.5, limits.acceleration / limits.jerk / s_curve_change(std::abs(change), limits));
  const UnitChange unit(ramp);
  // As a part of the time between the nodes, which the change takes whole.
  const double time = 2 * (to.distance - from.distance) / (from.velocity + to.velocity);
  double low = 0;
  double high = 1;
  constexpr int kHalvings = 50;
  for (int i = 0; i < kHalvings; ++i) {
    const double t = 0.5 * (low + high);
    const double gone = time * (from.velocity * t + change * unit.distance(t));
    (gone < distance ? low : high) = t;
  }
  return from.velocity + change * unit.speed(low);
}

}  // namespace

double s_curve_sampled_feed(std::span<const geometry::ParameterSample> samples,
                            const SCurveLimits& limits) {
  if (samples.empty()) return 0;
  const std::vector<SCurveNode> nodes = s_curve_nodes(samples, limits);
  double sum = 0;
  std::size_t next = 1;
  for (const geometry::ParameterSample& sample : samples) {
    while (next + 1 < nodes.size() && nodes[next].distance < sample.distance) ++next;
    const SCurveNode& from = nodes[next - 1];
    sum += speed_between(from, nodes[next], sample.distance - from.distance, limits);
  }
  return sum / static_cast<double>(samples.size());
}

double s_curve_time(std::span<const geometry::ParameterSample> samples,
                    const SCurveLimits& limits) {
  const std::vector<SCurveNode> nodes = s_curve_nodes(samples, limits);
  double time = 0;
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    const double distance = nodes[i].distance - nodes[i - 1].distance;
    if (distance > 0) time += 2 * distance / (nodes[i - 1].velocity + nodes[i].velocity);
  }
  return time;
}

}  // namespace batten::postproc
