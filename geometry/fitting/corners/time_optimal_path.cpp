#include "geometry/fitting/corners/time_optimal_path.h"

#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/blended_path.h"
#include "geometry/fitting/corners/guo_corner.h"
#include "geometry/fitting/corners/time_optimal_corner.h"

namespace batten::geometry {
namespace {

// Leg directions that agree in these steps, and shares (mm), are alike.
constexpr double kAlike = 1e-6;

// Measured deviations of one blend at two places differ by rounding.
constexpr double kMeasuringNoise = 1e-9;

// A racing line that bends this many times as hard as the five points do is none: where there is
// hardly any room (teeth of noise), the search ends with one that stands still on its way.
constexpr double kSharper = 2;

// Places of a racing line at which its curvature is looked at, to each of its spans.
constexpr int kPlacesPerSpan = 8;

using Directions = std::array<long long, 6>;

Directions directions_of(const CornerFrame& frame) {
  const auto steps = [](double x) { return std::llround(x / kAlike); };
  return {steps(frame.a.x()), steps(frame.a.y()), steps(frame.a.z()),
          steps(frame.b.x()), steps(frame.b.y()), steps(frame.b.z())};
}

bool bends_more_than(const BsplineCurve& curve, double curvature) {
  const std::vector<double> breaks = curve.breakpoints();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (int k = 0; k < kPlacesPerSpan; ++k) {
      const double u = breaks[i] + (k + 0.5) / kPlacesPerSpan * (breaks[i + 1] - breaks[i]);
      if (!(curve.curvature_at(u) <= curvature)) return true;
    }
  }
  return false;
}

// A blend that was found, with the vertex and the shares it was found for.
struct Known {
  TimeOptimalBlend found;
  Point3 vertex;
  double share_before;
  double share_after;

  // Whether a search with these shares would find the same: they are the same, or neither search
  // is bound by them.
  [[nodiscard]] bool serves(const SharedCorner& corner) const {
    return serves(found.before, share_before, corner.share_before) &&
           serves(found.after, share_after, corner.share_after);
  }

 private:
  [[nodiscard]] static bool serves(double used, double share, double other) {
    if (std::abs(share - other) <= kAlike) return true;
    return used < share - kAlike && used < other - kAlike;
  }
};

class TimeOptimalBlender {
 public:
  explicit TimeOptimalBlender(const TimeOptimalPathOptions& options) : options_(options) {}

  std::variant<TimeOptimalPathBlend, NoBlend> blend(const SharedCorner& shared) {
    const auto framed = frame_of(shared.corner);
    if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
    const auto& frame = std::get<CornerFrame>(framed);
    const ToleranceKind kind = kind_at(shared.corner, options_.kind, options_.strict_sharper_than);
    const GuoRule rule{options_.tolerance, kind, GuoApex::kAllowed};
    auto five = guo_corner(shared.corner, rule, shared.share_before, shared.share_after);
    if (turns_more(shared.corner, options_.least_raced_turn)) {
      auto raced = raced_blend(shared, frame, kind);
      const auto* other = std::get_if<GuoBlend>(&five);
      if (raced && (other == nullptr ||
                    !bends_more_than(raced->blend.curve, kSharper * other->greatest_curvature))) {
        return std::move(*raced);
      }
    }
    if (const auto* reason = std::get_if<NoBlend>(&five)) return *reason;
    return TimeOptimalPathBlend{std::move(std::get<GuoBlend>(five).blend), false};
  }

  [[nodiscard]] int searched() const { return searched_; }

 private:
  std::optional<TimeOptimalPathBlend> raced_blend(const SharedCorner& shared,
                                                  const CornerFrame& frame, ToleranceKind kind) {
    std::vector<Known>& alike = known_[directions_of(frame)];
    for (const Known& known : alike) {
      if (known.serves(shared)) {
        if (auto again = moved_there(known, frame, kind)) return again;
      }
    }
    if (searched_ >= options_.most_raced) return std::nullopt;
    ++searched_;
    TimeOptimalOptions time_optimal;
    time_optimal.tolerance = options_.tolerance;
    time_optimal.kind = kind;
    time_optimal.limits = options_.limits;
    time_optimal.share_before = shared.share_before;
    time_optimal.share_after = shared.share_after;
    auto outcome = time_optimal_corner(shared.corner, time_optimal);
    auto* found = std::get_if<TimeOptimalBlend>(&outcome);
    if (found == nullptr) return std::nullopt;
    alike.push_back({*found, frame.vertex, shared.share_before, shared.share_after});
    return TimeOptimalPathBlend{std::move(found->blend), true};
  }

  // Measured anew: it was found for another corner.
  [[nodiscard]] std::optional<TimeOptimalPathBlend> moved_there(const Known& known,
                                                                const CornerFrame& frame,
                                                                ToleranceKind kind) const {
    const BsplineCurve& curve = known.found.blend.curve;
    std::vector<Point3> points = curve.control_points();
    for (Point3& p : points) p += frame.vertex - known.vertex;
    BsplineCurve moved(curve.basis(), std::move(points));
    const BlendDeviation deviation = measure_blend(moved, frame);
    if (deviation_of(deviation, kind) > options_.tolerance * (1 + kMeasuringNoise)) {
      return std::nullopt;
    }
    return TimeOptimalPathBlend{{std::move(moved), deviation}, true};
  }

  const TimeOptimalPathOptions& options_;
  std::map<Directions, std::vector<Known>> known_;
  int searched_ = 0;
};

}  // namespace

TimeOptimalPath time_optimal_path(std::span<const Point3> points,
                                  const TimeOptimalPathOptions& options) {
  require_positive_tolerance(options.tolerance, "time_optimal_path");
  const DistinctVertices vertices = distinct_vertices(points, false);
  if (vertices.size() < 2) return {};
  TimeOptimalPath path;
  TimeOptimalBlender blender(options);
  std::vector<std::optional<BsplineCurve>> blends(vertices.size());
  for (const SharedCorner& each :
       shared_corners(vertices.points, false, options.keep_corner_angle)) {
    path.corners.push_back({vertices.indices[each.vertex], NoBlend::kKept});
    if (each.stays) continue;
    auto& outcome = path.corners.back().outcome;
    outcome = blender.blend(each);
    const auto* blend = std::get_if<TimeOptimalPathBlend>(&outcome);
    if (blend != nullptr) blends[each.vertex] = blend->blend.curve;
  }
  path.searched = blender.searched();
  BlendedPath rounded = blended_path(vertices.points, blends, false);
  path.pieces = std::move(rounded.pieces);
  path.stations = std::move(rounded.stations);
  return path;
}

}  // namespace batten::geometry
