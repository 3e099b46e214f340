#include "geometry/fitting/corners/ozcan_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/blended_path.h"

namespace batten::geometry {
namespace {

// Corners whose reach (mm) and leg directions agree in these steps are alike. The curve that
// one of them gets is measured for each other one before it is taken.
constexpr double kAlike = 1e-6;

// Measured deviations of one blend at two places differ by rounding.
constexpr double kMeasuringNoise = 1e-9;

using Key = std::array<long long, 7>;

Key key_of(const CornerFrame& frame, double reach) {
  const auto steps = [](double x) { return std::llround(x / kAlike); };
  return {steps(reach),       steps(frame.a.x()), steps(frame.a.y()), steps(frame.a.z()),
          steps(frame.b.x()), steps(frame.b.y()), steps(frame.b.z())};
}

class PathBlender {
 public:
  explicit PathBlender(const OzcanOptions& options) : options_(options) {}

  std::variant<OzcanBlend, NoBlend> blend(const SharedCorner& shared) {
    const auto framed = frame_of(shared.corner);
    if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
    const auto& frame = std::get<CornerFrame>(framed);
    const double share = std::min(shared.share_before, shared.share_after);
    const ToleranceKind kind = kind_at(shared.corner, options_.kind, options_.strict_sharper_than);
    OzcanLegs legs = ozcan_legs(frame, options_.tolerance, kind, share, share);
    // Mirrored, whatever the legs lack: the search then has two variables instead of four.
    if (legs.before[0] < legs.after[0]) legs.after = legs.before;
    if (legs.after[0] < legs.before[0]) legs.before = legs.after;
    if (!(legs.before[2] > kSamePlace)) return NoBlend::kNoRoom;
    if (!turns_more(shared.corner, options_.least_searched_turn)) {
      return usual(frame, legs, kind);
    }
    return searched(frame, legs, kind);
  }

  [[nodiscard]] int searched_corners() const { return searched_; }

 private:
  // With mirrored legs both deviations are that of the middle, (P3 + 23 P4) cos / 24 from the
  // vertex, so P4 follows from the tolerance.
  [[nodiscard]] std::variant<OzcanBlend, NoBlend> usual(const CornerFrame& frame,
                                                        const OzcanLegs& legs,
                                                        ToleranceKind kind) const {
    const bool band = kind == ToleranceKind::kBand;
    const double allowed = options_.tolerance / (band ? frame.sin_half : 1);
    const double third = legs.before[2];
    const double along = std::min(third, (24 * allowed / frame.cos_half - third) / 23);
    if (along < 0) return NoBlend::kNoRoom;
    return blend_with(frame, legs, {along, 0}, {along, 0});
  }

  [[nodiscard]] OzcanBlend blend_with(const CornerFrame& frame, const OzcanLegs& legs,
                                      const BesideLeg& fourth, const BesideLeg& fifth) const {
    BsplineCurve curve = ozcan_curve(frame, legs, fourth, fifth);
    const BlendDeviation deviation = measure_blend(curve, frame);
    const double feed = feed_estimate(curve, options_.limits);
    return {{std::move(curve), deviation}, fourth, fifth, feed, 1};
  }

  std::variant<OzcanBlend, NoBlend> searched(const CornerFrame& frame, const OzcanLegs& legs,
                                             ToleranceKind kind) {
    const Key key = key_of(frame, legs.before[0]);
    const auto known = alike_.find(key);
    if (known != alike_.end()) {
      OzcanBlend again = blend_with(frame, legs, known->second.first, known->second.second);
      const double off = deviation_of(again.blend.deviation, kind);
      if (off <= options_.tolerance * (1 + kMeasuringNoise)) return again;
    }
    ++searched_;
    auto found = ozcan_optimum(frame, legs, options_.tolerance, kind, options_.limits);
    if (const auto* blend = std::get_if<OzcanBlend>(&found)) {
      alike_[key] = {blend->fourth, blend->fifth};
    }
    return found;
  }

  const OzcanOptions& options_;
  std::map<Key, std::pair<BesideLeg, BesideLeg>> alike_;
  int searched_ = 0;
};

}  // namespace

OzcanPath ozcan_path(std::span<const Point3> points, const OzcanOptions& options) {
  require_positive_tolerance(options.tolerance, "ozcan_path");
  const DistinctVertices vertices = distinct_vertices(points, options.closed);
  if (vertices.size() < 2) return {};
  OzcanPath path;
  PathBlender blender(options);
  std::vector<std::optional<BsplineCurve>> blends(vertices.size());
  for (const SharedCorner& each :
       shared_corners(vertices.points, options.closed, options.keep_corner_angle)) {
    path.corners.push_back({vertices.indices[each.vertex], NoBlend::kKept});
    if (each.stays) continue;
    auto& outcome = path.corners.back().outcome;
    outcome = blender.blend(each);
    const auto* blend = std::get_if<OzcanBlend>(&outcome);
    if (blend != nullptr) blends[each.vertex] = blend->blend.curve;
  }
  path.searched = blender.searched_corners();
  BlendedPath rounded = blended_path(vertices.points, blends, options.closed);
  path.pieces = std::move(rounded.pieces);
  path.stations = std::move(rounded.stations);
  return path;
}

}  // namespace batten::geometry
