#include "geometry/path/parameter_samples.h"

#include <algorithm>

#include "geometry/basic/require.h"

namespace batten::geometry {
namespace {

// One span of a cubic: its first two derivatives by the curve's parameter, as Bezier polynomials.
class SpanDerivatives {
 public:
  SpanDerivatives(const CubicBezier& piece, double width) {
    const auto& p = piece.control;
    for (int i = 0; i < 3; ++i) first_[i] = 3 / width * (p[i + 1] - p[i]);
    for (int i = 0; i < 2; ++i) second_[i] = 2 / width * (first_[i + 1] - first_[i]);
  }

  // At part t of the span.
  [[nodiscard]] ParameterSample sample_at(double t, double parameter) const {
    const double s = 1 - t;
    const Vector3 first = s * s * first_[0] + 2 * s * t * first_[1] + t * t * first_[2];
    const Vector3 second = s * second_[0] + t * second_[1];
    const double speed = first.norm();
    const Vector3 axis = first.cross(second);
    const double curvature = speed > 0 ? axis.norm() / (speed * speed * speed) : 0;
    return {parameter, 0, speed, curvature, axis};
  }

 private:
  Vector3 first_[3];
  Vector3 second_[2];
};

}  // namespace

std::vector<ParameterSample> parameter_samples(const BsplineCurve& curve, int steps) {
  require(steps >= 1, "parameter_samples: steps", steps, "1 or more");
  const std::vector<double> knots = curve.breakpoints();
  const std::vector<CubicBezier> pieces = curve.bezier_pieces();
  std::vector<ParameterSample> samples;
  samples.reserve(pieces.size() * static_cast<std::size_t>(steps) + 1);
  for (std::size_t span = 0; span < pieces.size(); ++span) {
    const double width = knots[span + 1] - knots[span];
    const SpanDerivatives derivatives(pieces[span], width);
    if (span == 0) samples.push_back(derivatives.sample_at(0, knots[0]));
    for (int i = 1; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      const double u = i == steps ? knots[span + 1] : knots[span] + width * t;
      ParameterSample next = derivatives.sample_at(t, u);
      const ParameterSample& last = samples.back();
      next.distance = last.distance + 0.5 * (last.speed + next.speed) * (u - last.parameter);
      samples.push_back(next);
    }
  }
  return samples;
}

double max_curvature(std::span<const ParameterSample> samples) {
  double most = 0;
  for (const ParameterSample& sample : samples) most = std::max(most, sample.curvature);
  return most;
}

double mean_curvature(std::span<const ParameterSample> samples) {
  if (samples.empty()) return 0;
  double sum = 0;
  for (const ParameterSample& sample : samples) sum += sample.curvature;
  return sum / static_cast<double>(samples.size());
}

double sampled_length(std::span<const ParameterSample> samples) {
  return samples.empty() ? 0 : samples.back().distance;
}

std::size_t bends_of(std::span<const ParameterSample> samples, double least_turn) {
  std::size_t bends = 0;
  double turn = 0;
  Vector3 axis = Vector3::Zero();  // the last one: where it goes straight on it has none
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const ParameterSample& a = samples[i - 1];
    const ParameterSample& b = samples[i];
    if (axis.dot(b.axis) < 0) turn = 0;
    if (!b.axis.isZero(0)) axis = b.axis;
    const double before = turn;
    turn += 0.5 * (a.curvature + b.curvature) * (b.distance - a.distance);
    if (before < least_turn && turn >= least_turn) ++bends;
  }
  return bends;
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
