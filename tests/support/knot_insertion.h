// Curves with more knots than they need.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// The same curve with one more knot at u in ]first, last[. (Boehm 1980.)
inline BsplineCurve with_knot(const BsplineCurve& curve, double u) {
  // Boehm's insertion: point i of the new polygon divides the old leg i-1, i where the new
  // knot divides the support of that leg.
  const std::size_t k = curve.basis().find_span(u);
  const auto& t = curve.basis().knots();
  const int p = curve.degree();
  const std::vector<Point3>& before = curve.control_points();
  std::vector<double> knots = t;
  knots.insert(knots.begin() + static_cast<std::ptrdiff_t>(k) + 1, u);
  std::vector<Point3> points;
  points.reserve(before.size() + 1);
  for (std::size_t i = 0; i <= before.size(); ++i) {
    if (i + p <= k) {
      points.push_back(before[i]);
    } else if (i > k) {
      points.push_back(before[i - 1]);
    } else {
      const double alpha = (u - t[i]) / (t[i + p] - t[i]);
      points.push_back((1 - alpha) * before[i - 1] + alpha * before[i]);
    }
  }
  return {BsplineBasis(p, std::move(knots)), std::move(points)};
}

}  // namespace batten::geometry
