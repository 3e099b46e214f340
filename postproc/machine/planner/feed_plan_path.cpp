#include "postproc/machine/planner/feed_plan_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <variant>

#include "geometry/basic/rounding.h"
#include "geometry/numeric/extrema.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::postproc {
namespace {

using geometry::Vector3;

void require(bool holds, double value, const char* name, const char* expected) {
  if (holds) return;
  throw std::invalid_argument("KinematicPathLimits: " + std::string(name) + " is " +
                              std::to_string(value) + ", expected " + expected);
}

void require_positive(double value, const char* name) {
  require(value > 0, value, name, "above 0");
}

void require_not_negative(double value, const char* name) {
  require(value >= 0, value, name, "0 or more");
}

// How far `direction` goes until the first axis meets its limit.
double along(const Vector3& direction, const Vector3& limit) {
  double least = KinematicPathLimits::kNone;
  for (int axis = 0; axis < 3; ++axis) {
    const double part = std::abs(direction[axis]);
    if (part > 0) least = std::min(least, limit[axis] / part);
  }
  return least;
}

}  // namespace

void require_sound(const KinematicPathLimits& limits) {
  require_positive(limits.feed, "feed");
  for (int axis = 0; axis < 3; ++axis) {
    require_positive(limits.speed[axis], "speed");
    require_positive(limits.acceleration[axis], "acceleration");
    require_positive(limits.jerk[axis], "jerk");
    require_not_negative(limits.speed_step[axis], "speed_step");
  }
  require_positive(limits.tangential_acceleration, "tangential_acceleration");
  require_positive(limits.tangential_jerk, "tangential_jerk");
  require_positive(limits.normal_acceleration, "normal_acceleration");
  require_not_negative(limits.period, "period");
  if (std::isinf(limits.feed) && std::isinf(limits.speed.maxCoeff())) {
    throw std::invalid_argument("KinematicPathLimits: neither a feed nor a speed for every axis");
  }
}

bool has_jerk_limit(const KinematicPathLimits& limits) {
  return !std::isinf(std::min(limits.jerk.minCoeff(), limits.tangential_jerk));
}

LimitsAlong limits_along(const Vector3& direction, const KinematicPathLimits& limits) {
  return {std::min(limits.feed, along(direction, limits.speed)),
          std::min(limits.tangential_acceleration, along(direction, limits.acceleration)),
          std::min(limits.tangential_jerk, along(direction, limits.jerk))};
}

namespace {

using geometry::Arc;
using geometry::CubicBezier;
using geometry::CubicPolynomial;
using geometry::Line;

// By the parameter of the piece.
struct Derivatives {
  Vector3 first;
  Vector3 second;
  Vector3 third;
};

// Radius, angle and height are linear in t, so with the unit vectors outward o and forward f,
// o' = sweep f and f' = -sweep o.
Derivatives derivatives_at(const Arc& arc, double t) {
  const Vector3 from = arc.start - arc.center;
  const Vector3 to = arc.end - arc.center;
  const double rise = arc.axis.dot(to - from);
  const Vector3 out_from = from - arc.axis.dot(from) * arc.axis;
  const double radius_from = out_from.norm();
  const double growth = (to - arc.axis.dot(to) * arc.axis).norm() - radius_from;
  const double radius = radius_from + t * growth;
  const double w = arc.sweep;
  Vector3 e = out_from.normalized();
  if (!(radius_from > 0)) {  // a spiral from its axis: the direction of its end, turned back
    const Vector3 out_to = (to - arc.axis.dot(to) * arc.axis).normalized();
    e = std::cos(w) * out_to - std::sin(w) * arc.axis.cross(out_to);
  }
  const Vector3 o = std::cos(w * t) * e + std::sin(w * t) * arc.axis.cross(e);
  const Vector3 f = arc.axis.cross(o);
  return {growth * o + radius * w * f + rise * arc.axis, 2 * growth * w * f - radius * w * w * o,
          -3 * growth * w * w * o - radius * w * w * w * f};
}

double size_of(const CubicBezier& bezier) {
  double size = 0;
  for (int i = 1; i < 4; ++i) {
    size = std::max(size, (bezier.control[i] - bezier.control[0]).cwiseAbs().maxCoeff());
  }
  return size;
}

// A derivative below this part of the piece's size counts as none, and a place this much of the
// parameter further in stands for it: derivatives by length are some 1e3 / size there, finite, and
// the piece is left behind within a millionth of its size.
constexpr double kNoDerivative = 1e-6;
constexpr double kCloseBy = 1e-3;

Derivatives derivatives_at(const CubicBezier& bezier, double t) {
  const CubicPolynomial piece(bezier);
  return {piece.first(t), piece.second(t), piece.third()};
}

Derivatives derivatives_at(const Line& line, double) {
  return {line.end - line.start, Vector3::Zero(), Vector3::Zero()};
}

Derivatives derivatives_at(const geometry::PathPiece& piece, double t) {
  return std::visit([t](const auto& p) { return derivatives_at(p, t); }, piece);
}

// What an axis may jump at a kink and where the curvature jumps, mm/s and mm/s^2.
Vector3 speed_jump(const KinematicPathLimits& limits) {
  Vector3 allowed = limits.speed_step;
  if (limits.period > 0) {
    const double period = limits.period;
    const Vector3 felt_not =
        (limits.jerk * (period * period / 4)).cwiseMin(limits.acceleration * period);
    allowed = allowed.cwiseMax(felt_not);
  }
  return allowed;
}

Vector3 acceleration_jump(const KinematicPathLimits& limits) {
  Vector3 allowed = limits.jerk;
  for (double& jump : allowed) jump = std::isinf(jump) ? jump : jump * limits.period;
  return allowed;
}

// A joint whose speed the machine reaches from rest within this way is a stop: the way is a
// thousandth of the last printed decimal.
constexpr double kStopWay = 1e-6;  // mm

}  // namespace

LengthDerivatives derivatives_by_length(const geometry::PathPiece& piece, double t) {
  Derivatives d = derivatives_at(piece, t);
  const auto* bezier = std::get_if<CubicBezier>(&piece);
  if (bezier != nullptr && !(d.first.norm() > kNoDerivative * size_of(*bezier))) {
    d = derivatives_at(*bezier, t + (t < 0.5 ? kCloseBy : -kCloseBy));
  }
  return geometry::by_length(d.first, d.second, d.third);
}

double length_between(const geometry::PathPiece& piece, double t0, double t1) {
  const auto speed = [&](double t) { return derivatives_at(piece, t).first.norm(); };
  if (std::holds_alternative<Line>(piece)) return (t1 - t0) * speed(0);
  return geometry::gauss5(speed, t0, t1);
}

// By Newton steps.
double parameter_after(const geometry::PathPiece& piece, double t0, double t1, double length,
                       double s) {
  double t = t0 + (t1 - t0) * s / length;
  for (int i = 0; i < 6; ++i) {
    const double missing = s - length_between(piece, t0, t);
    if (std::abs(missing) < 1e-12 * length) break;
    t = std::clamp(t + missing * (t1 - t0) / length, t0, t1);
  }
  return t;
}

double joint_speed(const LengthDerivatives& before, const LengthDerivatives& after,
                   const KinematicPathLimits& limits) {
  double speed = KinematicPathLimits::kNone;
  const Vector3 turn = after.first - before.first;
  if (turn.norm() > geometry::kSameDirection) speed = along(turn, speed_jump(limits));
  const Vector3 bend = after.second - before.second;
  const double scale = std::max(before.second.norm(), after.second.norm());
  if (bend.norm() > geometry::kSameDirection * scale) {
    speed = std::min(speed, std::sqrt(along(bend, acceleration_jump(limits))));
  }
  if (std::isinf(speed)) return speed;
  const LimitsAlong here = limits_along(before.first, limits);
  // Rounding of control points looks like a jump, but a tiny one.
  if (speed >= here.speed) return KinematicPathLimits::kNone;
  const double slowest = has_jerk_limit(limits) ? std::cbrt(4.5 * here.jerk * kStopWay * kStopWay)
                                                : std::sqrt(2 * here.acceleration * kStopWay);
  return speed < slowest ? 0 : speed;
}

}  // namespace batten::postproc
