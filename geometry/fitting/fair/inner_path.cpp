#include "geometry/fitting/fair/inner_path.h"

#include <cstddef>

namespace batten::geometry {

namespace {

// 1/mm, towards the centre of the bend; zero where the curve stands still.
Vector3 bend_at(const BsplineCurve& curve, double u) {
  const Vector3 first = curve.derivative_at(u, 1);
  const double squared = first.squaredNorm();
  if (!(squared > 0)) return Vector3::Zero();
  const Vector3 second = curve.derivative_at(u, 2);
  return (second - second.dot(first) / squared * first) / squared;
}

}  // namespace

std::vector<Point3> drawn_inwards(std::span<const Point3> points, const SmoothCurve& curve,
                                  double most) {
  std::vector<Point3> moved(points.begin(), points.end());
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const double chord_squared = 0.5 * ((points[i] - points[i - 1]).squaredNorm() +
                                        (points[i + 1] - points[i]).squaredNorm());
    Vector3 move = chord_squared / 24 * bend_at(curve.curve, curve.vertex_parameters[i]);
    const double length = move.norm();
    if (length > most) move *= most / length;
    moved[i] += move;
  }
  return moved;
}

}  // namespace batten::geometry
