#include "geometry/fitting/naseath/naseath_mover.h"

#include <algorithm>
#include <utility>

#include "geometry/fitting/naseath/naseath_directions.h"
#include "geometry/fitting/naseath/naseath_sensitivity.h"

namespace batten::geometry {

namespace {

// A move that is taken back is tried again at half its size, and not at all below this part.
constexpr double kLeastPart = 1.0 / 64;

}  // namespace

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
  const std::vector<double> sizes = sizes_of(polygon, categories, directions, room);
  const ControlPolygon before = polygon;
  bool moved = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (setting_.is_held(i)) continue;
    const Vector3 step = sizes[i] * directions[i];
    moved = moved || !step.isZero(0);
    polygon.points[i] += step;
  }
  measure(directions, sizes);
  if (guard_) take_back(polygon, before);
  return moved;
}

// The nominal moves: the room, all of it for the least sensitive point, and in proportion to 1/S
// for the others.
std::vector<double> NaseathMover::sizes_of(const ControlPolygon& polygon,
                                           const NaseathCategories& categories,
                                           const std::vector<Vector3>& directions,
                                           const NaseathRoom& room) const {
  const NaseathRepairs& repairs = setting_.options.repairs;
  const std::size_t m = polygon.size();
  std::vector<double> sizes(m, 0);
  double greatest = 0;
  for (std::size_t i = 0; i < m; ++i) {
    const bool stopped = repairs.local_stop && room.per_point[i] < setting_.at_tube();
    if (stopped || parts_[i] <= 0) continue;
    sizes[i] = 1 / std::max(sensitivities_[i], repairs.sensitivity_floor);
    greatest = std::max(greatest, sizes[i]);
  }
  for (std::size_t i = 0; i < m; ++i) {
    if (sizes[i] <= 0) continue;
    sizes[i] *= parts_[i] * room.per_point[i] / greatest;
    if (repairs.clamp_moves) {
      const double target = distance_to_target(polygon, categories, i, directions[i]);
      sizes[i] = std::clamp(target, 0.0, sizes[i]);
    }
  }
  return sizes;
}

// Where the curve would bend harder than the old one did thereabouts, its points go back to where
// they were. That ends, since the polygon before the pass bends nowhere too hard.
void NaseathMover::take_back(ControlPolygon& polygon, const ControlPolygon& before) {
  std::vector<bool> back(polygon.size(), false);
  for (auto spans = guard_->broken(polygon); !spans.empty(); spans = guard_->broken(polygon)) {
    for (const std::size_t span : spans) {
      for (std::size_t k = span; k <= span + kNaseathDegree; ++k) back[k % polygon.size()] = true;
    }
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      if (back[i]) polygon.points[i] = before.points[i];
    }
  }
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    if (back[i]) parts_[i] = parts_[i] / 2 < kLeastPart ? 0 : parts_[i] / 2;
  }
}

void NaseathMover::measure(const std::vector<Vector3>& directions,
                           const std::vector<double>& sizes) {
  std::vector<Point3> moves(sizes.size(), Point3::Zero());
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (!setting_.is_held(i)) moves[i] = sizes[i] * directions[i];
  }
  sensitivities_ = naseath_sensitivities(setting_.curve_of(std::move(moves)), setting_.parameters,
                                         sizes, sensitivities_);
}

}  // namespace batten::geometry
