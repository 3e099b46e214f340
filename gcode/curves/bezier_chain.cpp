#include "gcode/curves/bezier_chain.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace batten::gcode {

using geometry::CubicBezier;
using geometry::Point3;
using geometry::Vector3;

double greatest_move(std::span<const CubicBezier> a, std::span<const CubicBezier> b) {
  if (a.size() != b.size()) {
    throw std::invalid_argument("greatest_move: " + std::to_string(b.size()) +
                                " pieces, expected " + std::to_string(a.size()));
  }
  double greatest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (int j = 0; j < 4; ++j) {
      greatest = std::max(greatest, (a[i].control[j] - b[i].control[j]).norm());
    }
  }
  return greatest;
}

CubicBezier between(const CubicBezier& piece, const Point3& start, const Point3& end) {
  const Point3* p = piece.control;
  return {{start, p[1] + (start - p[0]), p[2] + (end - p[3]), end}};
}

CubicCoefficients coefficients_of(const CubicBezier& piece) {
  const Point3* p = piece.control;
  return {{p[0], 3 * (p[1] - p[0]), 3 * (p[0] - 2 * p[1] + p[2]), p[3] - p[0] - 3 * (p[2] - p[1])}};
}

CubicBezier bezier_of(const CubicCoefficients& coefficients) {
  const Vector3* a = coefficients.a;
  return {{a[0], a[0] + a[1] / 3, a[0] + (2 * a[1] + a[2]) / 3, a[0] + a[1] + a[2] + a[3]}};
}

double kink_between(const CubicBezier& before, const CubicBezier& after) {
  const Vector3 arriving = geometry::direction_at(before, 1);
  const Vector3 leaving = geometry::direction_at(after, 0);
  // Zero vectors make both parts zero, and the angle 0.
  return std::atan2(arriving.cross(leaving).norm(), arriving.dot(leaving));
}

}  // namespace batten::gcode
