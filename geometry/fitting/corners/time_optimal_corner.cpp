#include "geometry/fitting/corners/time_optimal_corner.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/time_optimal_line.h"

namespace batten::geometry {

namespace {

void check(const TimeOptimalOptions& options) {
  require_positive_tolerance(options.tolerance, "time_optimal_corner");
  if (options.spans < 8) {
    throw std::invalid_argument("time_optimal_corner: " + std::to_string(options.spans) +
                                " spans, expected 8 or more");
  }
  for (int axis = 0; axis < 3; ++axis) {
    if (std::isfinite(options.limits.acceleration[axis]) ||
        std::isfinite(options.limits.jerk[axis])) {
      continue;
    }
    throw std::invalid_argument("time_optimal_corner: axis " + std::to_string(axis) +
                                " with neither acceleration nor jerk limited");
  }
  if (!(options.limits.feed > 0 && std::isfinite(options.limits.feed))) {
    throw std::invalid_argument("time_optimal_corner: feed " + std::to_string(options.limits.feed) +
                                " mm/s, expected a positive number");
  }
}

}  // namespace

std::variant<TimeOptimalBlend, NoBlend> time_optimal_corner(const Corner& corner,
                                                            const TimeOptimalOptions& options) {
  check(options);
  const auto framed = frame_of(corner);
  if (const auto* none = std::get_if<NoBlend>(&framed)) return *none;
  const TimeOptimalLine line(std::get<CornerFrame>(framed), options);
  if (!line.has_room()) return NoBlend::kNoRoom;
  auto found = line.fastest(1);
  if (!found) return NoBlend::kNoRoom;
  return std::move(*found);
}

std::variant<TimeOptimalBlend, NoBlend> time_optimal_corner(const Corner& corner,
                                                            const TimeOptimalOptions& options,
                                                            const CurveTimer& timer) {
  check(options);
  const auto framed = frame_of(corner);
  if (const auto* none = std::get_if<NoBlend>(&framed)) return *none;
  const TimeOptimalLine line(std::get<CornerFrame>(framed), options);
  if (!line.has_room()) return NoBlend::kNoRoom;
  std::optional<TimeOptimalBlend> best;
  double least = std::numeric_limits<double>::infinity();
  for (const double room : {0.6, 0.8, 1.0, 1.3}) {
    auto found = line.fastest(room);
    if (!found) continue;
    const double time = timer(with_legs(*found, corner));
    if (time < least) {
      least = time;
      best = std::move(found);
    }
  }
  if (!best) return NoBlend::kNoRoom;
  return std::move(*best);
}

BsplineCurve with_legs(const TimeOptimalBlend& blend, const Corner& corner) {
  // Blend and legs meet with one speed and no acceleration, so the joint is a simple knot. The
  // control points of a straight stretch lie at the means of three knots; the blend's own are
  // kept from the third on, whose knots are the joint and the two behind it.
  const BsplineCurve& curve = blend.blend.curve;
  const auto inner = curve.breakpoints();
  const auto& own = curve.control_points();
  const double way_before = (corner.before - own.front()).norm();
  const double way_after = (corner.after - own.back()).norm();
  std::vector<double> breaks = inner;
  std::vector<Point3> points(own.begin() + 2, own.end() - 2);
  if (way_before > kSamePlace) {
    const double start = inner.front() - way_before / blend.speed_before;
    const Vector3 speed = (own.front() - corner.before) / (inner.front() - start);
    const Point3 third = corner.before + (inner.front() + inner[1] - 2 * start) / 3 * speed;
    const Point3 second = corner.before + (inner.front() - start) / 3 * speed;
    points.insert(points.begin(), {corner.before, second, third});
    breaks.insert(breaks.begin(), start);
  } else {
    points.insert(points.begin(), own.begin(), own.begin() + 2);
  }
  if (way_after > kSamePlace) {
    const double end = inner.back() + way_after / blend.speed_after;
    const Vector3 speed = (corner.after - own.back()) / (end - inner.back());
    const Point3 third =
        corner.after - (2 * end - inner.back() - inner[inner.size() - 2]) / 3 * speed;
    const Point3 second = corner.after - (end - inner.back()) / 3 * speed;
    points.insert(points.end(), {third, second, corner.after});
    breaks.push_back(end);
  } else {
    points.insert(points.end(), own.end() - 2, own.end());
  }
  return {BsplineBasis::clamped(3, breaks), std::move(points)};
}

}  // namespace batten::geometry
