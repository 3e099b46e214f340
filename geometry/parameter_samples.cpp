#include "geometry/parameter_samples.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace batten::geometry {

namespace {

ParameterSample sample_at(const BsplineCurve& curve, double u) {
  const Vector3 first = curve.derivative_at(u, 1);
  const double speed = first.norm();
  const double across = first.cross(curve.derivative_at(u, 2)).norm();
  return {u, 0, speed, speed > 0 ? across / (speed * speed * speed) : 0};
}

}  // namespace

std::vector<ParameterSample> parameter_samples(const BsplineCurve& curve, int steps) {
  if (steps < 1) {
    throw std::invalid_argument("parameter_samples: " + std::to_string(steps) +
                                " steps, expected 1 or more");
  }
  const std::vector<double> knots = curve.breakpoints();
  std::vector<ParameterSample> samples = {sample_at(curve, knots.front())};
  samples.reserve((knots.size() - 1) * static_cast<std::size_t>(steps) + 1);
  for (std::size_t span = 0; span + 1 < knots.size(); ++span) {
    const double width = knots[span + 1] - knots[span];
    for (int i = 1; i <= steps; ++i) {
      const double u = i == steps ? knots[span + 1] : knots[span] + width * i / steps;
      ParameterSample next = sample_at(curve, u);
      const ParameterSample& last = samples.back();
      next.distance =
          last.distance + 0.5 * (last.speed + next.speed) * (next.parameter - last.parameter);
      samples.push_back(next);
    }
  }
  return samples;
}

double mean_curvature(std::span<const ParameterSample> samples) {
  if (samples.empty()) return 0;
  double sum = 0;
  for (const ParameterSample& sample : samples) sum += sample.curvature;
  return sum / static_cast<double>(samples.size());
}

double max_curvature(std::span<const ParameterSample> samples) {
  double most = 0;
  for (const ParameterSample& sample : samples) most = std::max(most, sample.curvature);
  return most;
}

double sampled_length(std::span<const ParameterSample> samples) {
  return samples.empty() ? 0 : samples.back().distance;
}

double bending(std::span<const ParameterSample> samples) {
  double sum = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double a = samples[i - 1].curvature;
    const double b = samples[i].curvature;
    sum += 0.5 * (a * a + b * b) * (samples[i].distance - samples[i - 1].distance);
  }
  return sum;
}

}  // namespace batten::geometry
