// A closed path without a seam: it is faired with some of its vertices repeated before its start
// and after its end, and one period is cut out. Method: docs/algorithms/fair.md, section Closed
// runs.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// A curve along a chain of vertices.
struct Faired {
  BsplineCurve curve;
  std::vector<double> parameters;  // of each vertex, increasing
};

// Greatest distance between the curve and the polyline, by samples, near in order.
[[nodiscard]] double deviation_of(const Faired& faired, std::span<const Point3> points,
                                  double limit);

// The vertices of a closed run (the first is the last) with `wrap` more of them on either side.
// Requires wrap < points.size().
[[nodiscard]] std::vector<Point3> wrapped(std::span<const Point3> points, std::size_t wrap);

// The `count` vertices from `wrap` on of a curve along wrapped vertices.
[[nodiscard]] Faired one_period(const Faired& all, std::size_t wrap, std::size_t count);

// The period without a seam where the tolerance allows it; with one of the size of the fit's error,
// some thousandths of a radian, where joining would leave the band; nothing where neither holds.
[[nodiscard]] std::optional<Faired> closed_at_seam(const Faired& period,
                                                   std::span<const Point3> points,
                                                   double tolerance);

}  // namespace batten::geometry
