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
