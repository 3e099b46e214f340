// Bezier pieces with weights and of any degree, and cubic pieces in their place: controls run such
// curves, and everything that follows a path here knows cubic pieces.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// A point with its weight in homogeneous coordinates: (w x, w y, w z, w); mm.
using WeightedPoint = Eigen::Vector4d;

[[nodiscard]] WeightedPoint weighted(const Point3& point, double weight);
[[nodiscard]] Point3 place_of(const WeightedPoint& point);

// The control points of one more than the degree; at least two.
struct RationalBezier {
  std::vector<WeightedPoint> control;
};

[[nodiscard]] Point3 point_at(const RationalBezier& piece, double t);

// One for each span of the knots that is not empty, in order. The points are basis.size().
[[nodiscard]] std::vector<RationalBezier> rational_pieces(const BsplineBasis& basis,
                                                          std::span<const WeightedPoint> points);

// Cubic pieces that chain, each over a half, a quarter .. of the piece, with its ends and its
// derivatives there, and nowhere farther (mm) from it than `within`, at the same parameter: for the
// piece P / w and a cubic C the Bernstein coefficients of P - w C over the least weight bound their
// distance. Nothing where that takes more than 256 of them, as where a weight is not positive.
[[nodiscard]] std::optional<std::vector<CubicBezier>> cubic_pieces(const RationalBezier& piece,
                                                                   double within);

}  // namespace batten::geometry
