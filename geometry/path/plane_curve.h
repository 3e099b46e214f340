// A curve seen along an axis: pieces in a local frame whose third coordinate is the height
// along the axis, with the tangent's angle in the plane counted on over the whole curve.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/path.h"

namespace batten::geometry {

[[nodiscard]] inline double cross(const Vector2& a, const Vector2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

[[nodiscard]] Vector2 unit_vector(double angle);

// Right-handed axes: the first two span the plane, the third is the arcs' axis. For X, Y and Z (and
// their opposites) these are coordinate axes: rounding a local coordinate rounds a coordinate.
struct PlaneFrame {
  Eigen::Matrix3d to_local;

  [[nodiscard]] static PlaneFrame across(const Vector3& axis);
  [[nodiscard]] Point3 local(const Point3& p) const { return to_local * p; }
  [[nodiscard]] Point3 global(const Point3& p) const { return to_local.transpose() * p; }
};

class PlaneCurve : public PieceRow {
 public:
  // Pieces that turn by more than a radian are halved.
  PlaneCurve(const CurvePieces& pieces, const PlaneFrame& frame);

  // Of the tangent in the plane, radians, continuous but for corners, where it is the angle of
  // leaving (`angle_before`: of arriving).
  [[nodiscard]] double angle_at(double u) const;
  [[nodiscard]] double angle_before(double u) const;

  // Signed curvature in the plane, 1/mm; 0 where the curve runs along the axis.
  [[nodiscard]] double curvature_at(double u) const;

  // Rise along the axis per mm in the plane; infinite where the curve runs along the axis.
  [[nodiscard]] double slope_at(double u) const;

 private:
  void append(const CubicBezier& piece, double from, double to, int halvings);
  [[nodiscard]] double angle_in(std::size_t i, double u) const;

  std::vector<double> start_angles_;  // per piece
  std::vector<double> end_angles_;
};

}  // namespace batten::geometry
