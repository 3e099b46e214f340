// Cubic B-splines for tests: through a given function, or with given straight parts.
#pragma once

#include <vector>

#include "geometry/path/bspline_curve.h"

namespace batten::geometry {

// A cubic with uniform knots that follows f on [from, to] with an error of the fourth order:
// control points (-f(g - h) + 8 f(g) - f(g + h)) / 6 at g, a knot of the grid of width h.
// f is also called up to two widths outside.
template <typename Function>
BsplineCurve curve_of(const Function& f, double from, double to, int spans) {
  const double h = (to - from) / spans;
  std::vector<double> knots;
  for (int j = -3; j <= spans + 3; ++j) knots.push_back(from + j * h);
  std::vector<Point3> points;
  for (int i = -1; i <= spans + 1; ++i) {
    const double g = from + i * h;
    points.push_back((-Point3(f(g - h)) + 8 * Point3(f(g)) - Point3(f(g + h))) / 6);
  }
  return BsplineCurve(BsplineBasis(3, knots), points).part(knots[3], knots[knots.size() - 4]);
}

// mm between two parameters.
inline double length_between(const BsplineCurve& curve, double from, double to) {
  double length = 0;
  if (!(from < to)) return length;
  for (const CubicBezier& piece : curve.part(from, to).bezier_pieces()) length += length_of(piece);
  return length;
}

}  // namespace batten::geometry
