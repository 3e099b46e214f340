// A path as its feed plan sees it: derivatives by length at a place, and lengths of parts.
#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "geometry/basic/point.h"
#include "geometry/path/kinematic_feed.h"
#include "geometry/path/path.h"

namespace batten::postproc {

// Infinity: no limit. All must be above 0, but period and speed_step may be 0.
//
// A place where the curvature jumps (a line that runs into an arc) asks for infinite jerk, one
// where the direction jumps (a kink) for infinite acceleration. A control sets its axes once
// per period, and what its limits could do within one period is not felt as a jump: there the
// acceleration of an axis may jump by jerk * period, and its speed by the lesser of
// jerk * period^2 / 4 (up and down again within the period) and acceleration * period, or by
// speed_step where that is more. The plan slows down until the jump is no greater, or stops.
struct KinematicPathLimits {
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  double feed = kNone;                                                  // mm/s
  geometry::Vector3 speed = geometry::Vector3::Constant(kNone);         // mm/s, per axis
  geometry::Vector3 acceleration = geometry::Vector3::Constant(kNone);  // mm/s^2, per axis
  geometry::Vector3 jerk = geometry::Vector3::Constant(kNone);          // mm/s^3, per axis
  double tangential_acceleration = kNone;                               // mm/s^2, along the path
  double tangential_jerk = kNone;                                       // mm/s^3, along the path
  double normal_acceleration = kNone;                                   // mm/s^2, curvature * v^2
  double period = 0.001;                                                // s
  geometry::Vector3 speed_step = geometry::Vector3::Zero();             // mm/s, per axis, at a kink

  KinematicPathLimits() = default;
  explicit KinematicPathLimits(const geometry::KinematicLimits& axes)
      : feed(axes.feed), speed(axes.speed), acceleration(axes.acceleration), jerk(axes.jerk) {}
};

// Nodes in the time sqrt(v / jerk), half of what the machine needs for a change of its speed by v;
// the plan gets more where it needs them. The error of the time falls with the square of it.
inline constexpr double kPlanDensity = 6;

// For plans that are compared, or stand for the time of a control: good to a permille, and 0.3 %
// too slow at most where bends are slow. Between nodes limits may be exceeded, by some percent, and
// among hard corners by more for a millisecond.
inline constexpr double kQuickPlanDensity = 2;

// Of each piece of a path its own, or one for all of them.
using LimitsOfPieces = std::span<const KinematicPathLimits>;

[[nodiscard]] inline const KinematicPathLimits& limits_of(LimitsOfPieces limits,
                                                          std::size_t piece) {
  return limits.size() == 1 ? limits.front() : limits[piece];
}

// The greatest speeds at both ends, mm/s, each passed with any acceleration; 0 is rest, with
// acceleration 0. Where the ends are steady the speeds are exactly these, without acceleration;
// this requires way enough to come to them.
struct PlanEnds {
  double start_speed = 0;
  double end_speed = 0;
  bool are_steady = false;
};

// Throws std::invalid_argument, with the name of the limit, when one is not as said above, or when
// there is neither a feed nor a speed for every axis.
void require_sound(const KinematicPathLimits& limits);

// The limits along a straight direction (unit vector): the least over the axes and the path's own.
struct LimitsAlong {
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2
  double jerk = 0;          // mm/s^3
};

// Is the jerk of an axis or along the path limited?
[[nodiscard]] bool has_jerk_limit(const KinematicPathLimits& limits);

[[nodiscard]] LimitsAlong limits_along(const geometry::Vector3& direction,
                                       const KinematicPathLimits& limits);

using geometry::LengthDerivatives;

// Exact for lines, arcs, helices, spirals and Bezier pieces. Where a Bezier piece comes to a
// rest in its parameter (control points that coincide), those of a place close by.
[[nodiscard]] LengthDerivatives derivatives_by_length(const geometry::PathPiece& piece, double t);

// mm between two parameters, five-point Gauss-Legendre: for parts over which the speed of the
// parameter changes little.
[[nodiscard]] double length_between(const geometry::PathPiece& piece, double t0, double t1);

// The parameter `s` mm after t0, on a part of this length up to t1.
[[nodiscard]] double parameter_after(const geometry::PathPiece& piece, double t0, double t1,
                                     double length, double s);

// What a joint of two pieces allows, mm/s: 0 is a stop, infinity where the path runs on in
// direction and curvature, or where the joint allows what the machine can do at all.
[[nodiscard]] double joint_speed(const LengthDerivatives& before, const LengthDerivatives& after,
                                 const KinematicPathLimits& limits);

}  // namespace batten::postproc
