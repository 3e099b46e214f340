#include "geometry/fitting/naseath/naseath_choice.h"

#include <algorithm>
#include <span>

#include "geometry/path/parameter_samples.h"

namespace batten::geometry {

namespace {

// Places per span at which the curves of single passes are compared. The one that is returned
// is compared with the old curve at kNaseathSteps.
constexpr int kStepsPerPass = 32;

// Curvatures and bendings this much above each other, relatively, are equal but for rounding.
constexpr double kSameBending = 1e-9;

// A pass that bends less by a smaller part of it than this is no progress.
constexpr double kProgress = 1e-3;

std::vector<double> span_curvatures(const BsplineCurve& curve) {
  const auto samples = parameter_samples(curve, kStepsPerPass);
  std::vector<double> greatest;
  for (std::size_t from = 0; from + 1 < samples.size(); from += kStepsPerPass) {
    greatest.push_back(max_curvature(std::span(samples).subspan(from, kStepsPerPass + 1)));
  }
  return greatest;
}

}  // namespace

CurvatureGuard::CurvatureGuard(const NaseathSetting& setting) : setting_(setting) {
  const std::vector<double> old = span_curvatures(setting.curve_of(setting.original.points));
  const std::size_t spans = old.size();
  const bool ring = setting.original.closed;
  for (std::size_t j = 0; j < spans; ++j) {
    const std::size_t before = j > 0 ? j - 1 : (ring ? spans - 1 : j);
    const std::size_t after = j + 1 < spans ? j + 1 : (ring ? 0 : j);
    limits_.push_back(std::max({old[before], old[j], old[after]}) * (1 + kSameBending));
  }
}

std::vector<std::size_t> CurvatureGuard::broken(const ControlPolygon& polygon) const {
  const std::vector<double> now = span_curvatures(setting_.curve_of(polygon.points));
  std::vector<std::size_t> spans;
  for (std::size_t j = 0; j < now.size(); ++j) {
    if (now[j] > limits_[j]) spans.push_back(j);
  }
  return spans;
}

bool Fairness::no_worse_than(const Fairness& other) const {
  return max_curvature <= other.max_curvature * (1 + kSameBending) &&
         bending <= other.bending * (1 + kSameBending);
}

BestPass::BestPass(const NaseathSetting& setting)
    : setting_(setting),
      old_(fairness_of(setting.original, kStepsPerPass)),
      polygon_(setting.original),
      bending_(old_.bending),
      progress_(old_.bending) {}

void BestPass::offer(const ControlPolygon& polygon, int pass) {
  const Fairness fairness = fairness_of(polygon, kStepsPerPass);
  if (!fairness.no_worse_than(old_) || !(fairness.bending < bending_)) return;
  polygon_ = polygon;
  pass_ = pass;
  bending_ = fairness.bending;
  if (bending_ < progress_ * (1 - kProgress)) {
    progress_ = bending_;
    last_progress_ = pass;
  }
}

void BestPass::confirm() {
  if (pass_ == 0) return;
  const Fairness old = fairness_of(setting_.original, kNaseathSteps);
  if (fairness_of(polygon_, kNaseathSteps).no_worse_than(old)) return;
  polygon_ = setting_.original;
  pass_ = 0;
}

Fairness BestPass::fairness_of(const ControlPolygon& polygon, int steps) const {
  const auto samples = parameter_samples(setting_.curve_of(polygon.points), steps);
  return {geometry::max_curvature(samples), geometry::bending(samples)};
}

}  // namespace batten::geometry
