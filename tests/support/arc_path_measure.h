// What tests measure on a chain of arcs and lines against the curve that it stands for.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"
#include "tests/support/curve_of.h"

namespace batten::geometry {

struct ArcPathMeasure {
  double away = 0;        // mm, greatest distance at samples, both ways, taken in order
  double gap = 0;         // mm between neighbouring ends
  double kink = 0;        // radians, greatest
  double kink_grids = 0;  // greatest kink times the shorter neighbour's length, mm
  double least_radius = std::numeric_limits<double>::infinity();
  double greatest_radius = 0;
  double greatest_sweep = 0;
  double least_length = std::numeric_limits<double>::infinity();
  int arcs = 0;
};

// Both as dense polylines, a sample every `step` mm; for each sample of the one the nearest
// sample of the other, searched forward from the one before (so the order counts).
inline double ordered_distance(const std::vector<Point3>& a, const std::vector<Point3>& b,
                               double step) {
  const auto window = static_cast<std::size_t>(20);
  std::size_t at = 0;
  double worst = 0;
  for (const Point3& p : a) {
    std::size_t best = at;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t j = at; j < std::min(at + window, b.size()); ++j) {
      if ((b[j] - p).norm() < least) {
        least = (b[j] - p).norm();
        best = j;
      }
    }
    at = best;
    // Across the curve: the distance from the nearest of the two chords at that sample.
    double distance = least;
    for (int side : {-1, 1}) {
      const auto other = static_cast<std::ptrdiff_t>(best) + side;
      if (other < 0 || other >= static_cast<std::ptrdiff_t>(b.size())) continue;
      const Vector3 chord = b[static_cast<std::size_t>(other)] - b[best];
      if (chord.norm() < 1e-3 * step) continue;
      const double t = std::clamp((p - b[best]).dot(chord) / chord.squaredNorm(), 0.0, 1.0);
      distance = std::min(distance, (p - b[best] - t * chord).norm());
    }
    worst = std::max(worst, distance);
  }
  return worst;
}

inline ArcPathMeasure measure(const BsplineCurve& curve, const Path& path, double step) {
  ArcPathMeasure found;
  std::vector<Point3> on_curve;
  const std::vector<double> breaks = curve.breakpoints();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double length = length_between(curve, breaks[i], breaks[i + 1]);
    const int samples = static_cast<int>(std::ceil(length / step)) + 1;
    for (int k = 0; k < samples; ++k) {
      on_curve.push_back(curve.point_at(breaks[i] + (breaks[i + 1] - breaks[i]) * k / samples));
    }
  }
  on_curve.push_back(curve.point_at(curve.last()));
  std::vector<Point3> on_path;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const double length = length_of(path[i]);
    found.least_length = std::min(found.least_length, length);
    const int samples = static_cast<int>(std::ceil(length / step)) + 1;
    for (int k = i == 0 ? 0 : 1; k <= samples; ++k) {
      on_path.push_back(point_at(path[i], static_cast<double>(k) / samples));
    }
    if (const auto* arc = std::get_if<Arc>(&path[i])) {
      ++found.arcs;
      const Vector3 r = arc->start - arc->center;
      const double radius = (r - r.dot(arc->axis) * arc->axis).norm();
      found.least_radius = std::min(found.least_radius, radius);
      found.greatest_radius = std::max(found.greatest_radius, radius);
      found.greatest_sweep = std::max(found.greatest_sweep, std::abs(arc->sweep));
    }
    if (i == 0) continue;
    found.gap = std::max(found.gap, (start_point(path[i]) - end_point(path[i - 1])).norm());
    const Vector3 in = direction_at(path[i - 1], 1);
    const Vector3 out = direction_at(path[i], 0);
    const double kink = std::atan2(in.cross(out).norm(), in.dot(out));
    found.kink = std::max(found.kink, kink);
    found.kink_grids = std::max(found.kink_grids, kink * std::min(length, length_of(path[i - 1])));
  }
  found.away = std::max(ordered_distance(on_curve, on_path, step),
                        ordered_distance(on_path, on_curve, step));
  return found;
}

}  // namespace batten::geometry
