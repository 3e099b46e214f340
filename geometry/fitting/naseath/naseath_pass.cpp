#include "geometry/fitting/naseath/naseath_pass.h"

#include <algorithm>
#include <span>
#include <utility>

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

// A move that is taken back is tried again at half its size, and not at all below this part.
constexpr double kLeastPart = 1.0 / 64;

}  // namespace

CurvatureGuard::CurvatureGuard(const NaseathSetting& setting) : setting_(setting) {
  const std::vector<double> old = span_curvatures(setting.curve_of(setting.original));
  const std::size_t spans = old.size();
  for (std::size_t j = 0; j < spans; ++j) {
    const std::size_t before = j > 0 ? j - 1 : j;
    const std::size_t after = j + 1 < spans ? j + 1 : j;
    limits_.push_back(std::max({old[before], old[j], old[after]}) * (1 + kSameBending));
  }
}

std::vector<std::size_t> CurvatureGuard::broken(const ControlPolygon& polygon) const {
  const std::vector<double> now = span_curvatures(setting_.curve_of(polygon));
  std::vector<std::size_t> spans;
  for (std::size_t j = 0; j < now.size(); ++j) {
    if (now[j] > limits_[j]) spans.push_back(j);
  }
  return spans;
}

NaseathMover::NaseathMover(const NaseathSetting& setting)
    : setting_(setting),
      sensitivities_(setting.original.size(), 1),
      parts_(setting.original.size(), 1) {
  if (setting.options.repairs.guard_curvature) guard_.emplace(setting);
  const auto directions =
      naseath_directions(setting.original, categories_of(setting.original), setting.legs);
  measure(directions, std::vector<double>(directions.size(), setting.options.radius));
}

bool NaseathMover::move(ControlPolygon& polygon, const NaseathRoom& room) {
  const NaseathCategories categories = categories_of(polygon);
  const auto directions = naseath_directions(polygon, categories, setting_.legs);
  const std::vector<double> sizes = sizes_of(room);
  const ControlPolygon before = polygon;
  bool moved = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (setting_.is_held(i)) continue;
    const Vector3 step = sizes[i] * directions[i];
    moved = moved || !step.isZero(0);
    polygon[i] += step;
  }
  measure(directions, sizes);
  if (guard_) take_back(polygon, before);
  return moved;
}

// The nominal moves: the room, all of it for the least sensitive point, and in proportion to 1/S
// for the others.
std::vector<double> NaseathMover::sizes_of(const NaseathRoom& room) const {
  const NaseathRepairs& repairs = setting_.options.repairs;
  const std::size_t m = setting_.original.size();
  std::vector<double> sizes(m, 0);
  double greatest = 0;
  for (std::size_t i = 0; i < m; ++i) {
    const bool stopped = repairs.local_stop && room.per_point[i] < setting_.at_tube();
    if (stopped || parts_[i] <= 0) continue;
    sizes[i] = 1 / std::max(sensitivities_[i], repairs.sensitivity_floor);
    greatest = std::max(greatest, sizes[i]);
  }
  for (std::size_t i = 0; i < m; ++i) {
    if (sizes[i] > 0) sizes[i] *= parts_[i] * room.per_point[i] / greatest;
  }
  return sizes;
}

// Where the curve would bend harder than the old one did thereabouts, its points go back to where
// they were. That ends, since the polygon before the pass bends nowhere too hard.
void NaseathMover::take_back(ControlPolygon& polygon, const ControlPolygon& before) {
  std::vector<bool> back(polygon.size(), false);
  for (auto spans = guard_->broken(polygon); !spans.empty(); spans = guard_->broken(polygon)) {
    for (const std::size_t span : spans) {
      for (std::size_t k = span; k <= span + kNaseathDegree; ++k) back[k] = true;
    }
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (back[i]) polygon[i] = before[i];
    }
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (back[i]) parts_[i] = parts_[i] / 2 < kLeastPart ? 0 : parts_[i] / 2;
  }
}

void NaseathMover::measure(const std::vector<Vector3>& directions,
                           const std::vector<double>& sizes) {
  ControlPolygon moves(sizes.size(), Point3::Zero());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (!setting_.is_held(i)) moves[i] = sizes[i] * directions[i];
  }
  sensitivities_ = naseath_sensitivities(setting_.curve_of(std::move(moves)), setting_.parameters,
                                         sizes, sensitivities_);
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
  const auto samples = parameter_samples(setting_.curve_of(polygon), steps);
  return {geometry::max_curvature(samples), geometry::bending(samples)};
}

}  // namespace batten::geometry
