#include "postproc/machine/models/junction_speed.h"

#include <algorithm>
#include <cmath>

#include "geometry/basic/rounding.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {
namespace {

using geometry::kSameDirection;
using geometry::Vector3;

Vector3 of_xyz(const Machine& machine, double AxisLimits::*limit) {
  return {machine.axis(Axis::kX).*limit, machine.axis(Axis::kY).*limit,
          machine.axis(Axis::kZ).*limit};
}

// The least of limit / share over the axes that take part.
double least_ratio(const Vector3& limits, const Vector3& shares) {
  double least = kNoLimit;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double share = std::abs(shares[i]);
    if (share > 0) least = std::min(least, limits[i] / share);
  }
  return least;
}

// Arcs of G17, G18 and G19 lie across one axis; a helix moves along it too.
constexpr double kFlat = 1e-6;  // mm of rise

}  // namespace

Vector3 axis_velocities(const Machine& machine, bool rapid) {
  return of_xyz(machine, rapid ? &AxisLimits::rapid_velocity : &AxisLimits::velocity);
}

Vector3 axis_accelerations(const Machine& machine) {
  return of_xyz(machine, &AxisLimits::acceleration);
}

Vector3 axis_jerks(const Machine& machine) { return of_xyz(machine, &AxisLimits::jerk); }

KinematicPathLimits kinematic_limits(const Machine& machine, double feed, bool rapid) {
  KinematicPathLimits limits;
  limits.feed = std::min(feed / kMinute, machine.path_feed);
  limits.speed = axis_velocities(machine, rapid);
  limits.acceleration = axis_accelerations(machine);
  limits.jerk = axis_jerks(machine);
  limits.tangential_acceleration = machine.path_acceleration;
  limits.tangential_jerk = machine.path_jerk;
  limits.period = machine.servo_period;
  return limits;
}

double limit_along(const Vector3& direction, const Vector3& limits) {
  const double limit = least_ratio(limits, direction);
  return limit < kNoLimit ? limit : limits.minCoeff();
}

double limit_across(const Vector3& normal, const Vector3& limits) {
  Vector3 shares;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double square = 1 - normal[i] * normal[i];
    shares[i] = square > kSameDirection ? std::sqrt(square) : 0;
  }
  return least_ratio(limits, shares);
}

namespace {

// Of the axes that it moves, in whichever direction.
double limit_on_moved_axes(const geometry::CubicBezier& piece, const Vector3& limits) {
  double least = kNoLimit;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const bool moves = std::ranges::any_of(piece.control, [&](const geometry::Point3& point) {
      return std::abs(point[i] - piece.control[0][i]) > geometry::kSamePlace;
    });
    if (moves) least = std::min(least, limits[i]);
  }
  return least;
}

}  // namespace

double limit_on(const geometry::PathPiece& piece, const Vector3& limits) {
  if (std::holds_alternative<geometry::Line>(piece)) {
    return limit_along(geometry::direction_at(piece, 0), limits);
  }
  if (const auto* cubic = std::get_if<geometry::CubicBezier>(&piece)) {
    return limit_on_moved_axes(*cubic, limits);
  }
  const auto& arc = std::get<geometry::Arc>(piece);
  if (std::abs(arc.axis.dot(arc.end - arc.start)) > kFlat) return limits.minCoeff();
  return limit_across(arc.axis, limits);
}

double mean_limit_on(const geometry::PathPiece& piece, const Vector3& limits) {
  if (std::holds_alternative<geometry::Line>(piece)) return limit_on(piece, limits);
  if (std::isinf(limits.minCoeff())) return limits.minCoeff();
  constexpr double kApart = 0.4;  // radians
  constexpr int kMost = 8;
  const auto* arc = std::get_if<geometry::Arc>(&piece);
  const int places =
      arc == nullptr ? kMost
                     : std::clamp(static_cast<int>(std::abs(arc->sweep) / kApart) + 1, 1, kMost);
  double sum = 0;
  for (int i = 0; i < places; ++i) {
    sum += 1 / limit_along(geometry::direction_at(piece, (i + 0.5) / places), limits);
  }
  return places / sum;
}

double greatest_curvature(const geometry::PathPiece& piece) {
  double most = 0;
  for (const double t : {0.0, 0.5, 1.0}) most = std::max(most, geometry::curvature_at(piece, t));
  return most;
}

// With phi the angle between the two segments (180 degrees: straight on), the circle of
// radius R that touches both leaves the corner by R (1 - sin(phi/2)) / sin(phi/2).
double junction_deviation_speed(const Vector3& before, const Vector3& after, double deviation,
                                const Vector3& acceleration) {
  const Vector3 turn = after - before;
  if (turn.norm() <= kSameDirection) return kNoLimit;
  const double sin_half = std::sqrt(std::max(0.0, (1 + before.dot(after)) / 2));
  // 1 - sin_half would lose all digits at small turns: (1 - s)(1 + s) = (1 - dot) / 2.
  const double one_minus_sin_half = turn.squaredNorm() / 4 / (1 + sin_half);
  const double along_turn = limit_along(turn.normalized(), acceleration);
  return std::sqrt(along_turn * deviation * sin_half / one_minus_sin_half);
}

double velocity_step_speed(const Vector3& before, const Vector3& after, const Vector3& acceleration,
                           double period) {
  const Vector3 turn = after - before;
  if (turn.cwiseAbs().maxCoeff() <= kSameDirection) return kNoLimit;
  return least_ratio(acceleration * period, turn);
}

}  // namespace batten::postproc
