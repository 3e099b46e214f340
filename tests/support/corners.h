// Corners for tests: of a given angle, turned into space, and what samples say about a blend.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <variant>

#include "geometry/basic/rounding.h"
#include "geometry/fitting/corners/corner_blend.h"
#include "geometry/fitting/corners/ozcan_corner.h"

namespace batten::geometry {

inline constexpr double kDegrees = std::numbers::pi / 180;

// Half the angle between the legs in degrees: 45 is a square corner, 89 nearly straight.
inline Corner corner_of(double half_angle_degrees, double leg_before, double leg_after) {
  const double theta = half_angle_degrees * kDegrees;
  return {leg_before * Point3(-std::cos(theta), -std::sin(theta), 0), Point3::Zero(),
          leg_after * Point3(-std::cos(theta), std::sin(theta), 0)};
}

struct Motion {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vector3 shift = Vector3::Zero();

  Point3 operator()(const Point3& p) const { return turn * p + shift; }
  Corner operator()(const Corner& c) const {
    return {(*this)(c.before), (*this)(c.vertex), (*this)(c.after)};
  }
};

inline Motion random_motion(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto next = [&] { return normal(random); };
  const double w = next(), x = next(), y = next(), z = next();
  const Vector3 shift(20 * next(), 20 * next(), 20 * next());
  return {Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix(), shift};
}

inline Corner turned_back(const Corner& c) { return {c.after, c.vertex, c.before}; }

inline double segment_distance(const Point3& p, const Point3& from, const Point3& to) {
  const Vector3 along = to - from;
  const double t = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - from - t * along).norm();
}

// The eight points for a corner that may be degenerate, on so much of each leg.
inline std::variant<OzcanBlend, NoBlend> ozcan_corner(
    const Corner& corner, double tolerance, ToleranceKind kind, const KinematicLimits& limits = {},
    double share = std::numeric_limits<double>::infinity()) {
  const auto framed = frame_of(corner);
  if (const auto* reason = std::get_if<NoBlend>(&framed)) return *reason;
  const auto& frame = std::get<CornerFrame>(framed);
  const OzcanLeg leg = ozcan_leg(frame, tolerance, kind, share);
  if (!(leg[2] > kSamePlace)) return NoBlend::kNoRoom;
  return ozcan_optimum({frame, leg, tolerance, kind, limits});
}

// The deviation by plain samples, as slowly and simply as can be.
inline BlendDeviation sampled_deviation(const BsplineCurve& curve, const Corner& corner,
                                        int samples = 20000) {
  BlendDeviation found;
  found.corner = std::numeric_limits<double>::infinity();
  int nearest = 0;
  const auto at = [&](int i) {
    return curve.point_at(curve.first() + (curve.last() - curve.first()) * i / samples);
  };
  for (int i = 0; i <= samples; ++i) {
    const double away = (at(i) - corner.vertex).norm();
    if (away < found.corner) {
      found.corner = away;
      nearest = i;
    }
  }
  found.in_order = found.corner;
  for (int i = 0; i <= samples; ++i) {
    const double from_before = segment_distance(at(i), corner.before, corner.vertex);
    const double from_after = segment_distance(at(i), corner.vertex, corner.after);
    found.legs = std::max(found.legs, std::min(from_before, from_after));
    found.in_order = std::max(found.in_order, i <= nearest ? from_before : from_after);
  }
  return found;
}

// The blend goes on where the legs end: in place, direction and curvature.
struct JointMeasure {
  double off_leg = 0;    // mm, of the ends
  double turn = 0;       // difference of unit directions, greater of both ends
  double curvature = 0;  // 1/mm, greater of both ends
};

inline JointMeasure measure_joints(const BsplineCurve& curve, const Corner& corner) {
  const Point3 start = curve.point_at(curve.first());
  const Point3 end = curve.point_at(curve.last());
  const Vector3 in = (corner.vertex - corner.before).normalized();
  const Vector3 out = (corner.after - corner.vertex).normalized();
  return {std::max(segment_distance(start, corner.before, corner.vertex),
                   segment_distance(end, corner.vertex, corner.after)),
          std::max((curve.direction_at(curve.first()) - in).norm(),
                   (curve.direction_at(curve.last()) - out).norm()),
          std::max(curve.curvature_at(curve.first()), curve.curvature_at(curve.last()))};
}

}  // namespace batten::geometry
