// Cubic B-splines for tests: through a given function, or with given straight parts.
#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
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

// Lines and arcs as cubics joined by triple knots; arcs in pieces of 45 degrees or less,
// which a cubic follows to within 4e-6 of the radius.
class Drawing {
 public:
  explicit Drawing(const Point3& start) : points_{start} {}

  Drawing& line_to(const Point3& end) {
    const Point3 start = points_.back();
    add(start + (end - start) / 3, start + 2 * (end - start) / 3, end);
    return *this;
  }

  Drawing& arc_about(const Point3& center, double angle, double rise = 0) {
    const int pieces = static_cast<int>(std::ceil(std::abs(angle) / (std::numbers::pi / 4) - 1e-9));
    const double step = angle / pieces;
    const double handle = 4.0 / 3 * std::tan(step / 4);
    const Vector3 up(0, 0, rise / pieces);
    for (int i = 0; i < pieces; ++i) {
      const Point3 start = points_.back();
      const Vector3 r(start.x() - center.x(), start.y() - center.y(), 0);
      const Vector3 forward(-r.y(), r.x(), 0);
      const Vector3 turned = std::cos(step) * r + std::sin(step) * forward;
      const Vector3 turned_forward(-turned.y(), turned.x(), 0);
      const Point3 end = start - r + turned + up;
      add(start + handle * forward + up / 3, end - handle * turned_forward - up / 3, end);
    }
    return *this;
  }

  BsplineCurve curve() const {
    const std::size_t spans = (points_.size() - 1) / 3;
    std::vector<double> knots(4, 0.0);
    for (std::size_t i = 1; i < spans; ++i) knots.insert(knots.end(), 3, static_cast<double>(i));
    knots.insert(knots.end(), 4, static_cast<double>(spans));
    return {BsplineBasis(3, knots), points_};
  }

 private:
  void add(const Point3& a, const Point3& b, const Point3& c) {
    points_.insert(points_.end(), {a, b, c});
  }

  std::vector<Point3> points_;
};

// mm between two parameters.
inline double length_between(const BsplineCurve& curve, double from, double to) {
  double length = 0;
  if (!(from < to)) return length;
  for (const CubicBezier& piece : curve.part(from, to).bezier_pieces()) length += length_of(piece);
  return length;
}

}  // namespace batten::geometry
