#include "postproc/machine/planner/feed_plan_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>

#include "geometry/basic/rounding.h"
#include "geometry/path/cubic_polynomial.h"

namespace batten::postproc {
namespace {

using geometry::Vector3;

void require_positive(double value, const char* name) {
  if (value > 0) return;
  throw std::invalid_argument("KinematicPathLimits: " + std::string(name) + " is " +
                              std::to_string(value) + ", expected above 0");
}

void require_not_negative(double value, const char* name) {
  if (value >= 0) return;
  throw std::invalid_argument("KinematicPathLimits: " + std::string(name) + " is " +
                              std::to_string(value) + ", expected 0 or more");
}

// The length along `direction` at which the first axis meets its limit.
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
using geometry::Vector3;

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
  if (!(piece.first(t).norm() > kNoDerivative * size_of(bezier))) {
    t += t < 0.5 ? kCloseBy : -kCloseBy;
  }
  return {piece.first(t), piece.second(t), piece.third()};
}

// The chain rule, with sigma = |C'| and its derivatives by t.
LengthDerivatives by_length(const Derivatives& d) {
  const double sigma = d.first.norm();
  const double sigma1 = d.first.dot(d.second) / sigma;
  const double sigma2 = (d.second.squaredNorm() + d.first.dot(d.third) - sigma1 * sigma1) / sigma;
  const Vector3 n = sigma * d.second - sigma1 * d.first;
  const double cube = sigma * sigma * sigma;
  return {d.first / sigma, n / cube,
          ((sigma * d.third - sigma2 * d.first) / cube - 3 * sigma1 / (cube * sigma) * n) / sigma};
}

double parameter_speed(const geometry::PathPiece& piece, double t) {
  return std::visit(
      [t](const auto& p) {
        using Piece = std::decay_t<decltype(p)>;
        if constexpr (std::is_same_v<Piece, Line>) {
          return (p.end - p.start).norm();
        } else if constexpr (std::is_same_v<Piece, Arc>) {
          return derivatives_at(p, t).first.norm();
        } else {
          return CubicPolynomial(p).first(t).norm();
        }
      },
      piece);
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

// The greatest speed at which no axis of `jump` (per mm/s of speed) is above its limit.
double speed_for(const Vector3& jump, const Vector3& limit) {
  double speed = KinematicPathLimits::kNone;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = std::abs(jump[axis]);
    if (size > 0) speed = std::min(speed, limit[axis] / size);
  }
  return speed;
}

}  // namespace

LengthDerivatives derivatives_by_length(const geometry::PathPiece& piece, double t) {
  return std::visit(
      [t](const auto& p) -> LengthDerivatives {
        using Piece = std::decay_t<decltype(p)>;
        if constexpr (std::is_same_v<Piece, Line>) {
          return {(p.end - p.start).normalized(), Vector3::Zero(), Vector3::Zero()};
        } else {
          return by_length(derivatives_at(p, t));
        }
      },
      piece);
}

double length_between(const geometry::PathPiece& piece, double t0, double t1) {
  if (std::holds_alternative<Line>(piece)) return (t1 - t0) * parameter_speed(piece, 0);
  // Gauss-Legendre on [-1, 1].
  constexpr std::array<double, 3> kPlaces = {0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array<double, 3> kWeights = {0.5688888888888889, 0.4786286704993665,
                                              0.2369268850561891};
  const double middle = 0.5 * (t0 + t1);
  const double half = 0.5 * (t1 - t0);
  double sum = kWeights[0] * parameter_speed(piece, middle);
  for (int i = 1; i < 3; ++i) {
    sum += kWeights[i] * (parameter_speed(piece, middle - half * kPlaces[i]) +
                          parameter_speed(piece, middle + half * kPlaces[i]));
  }
  return half * sum;
}

double joint_speed(const LengthDerivatives& before, const LengthDerivatives& after,
                   const KinematicPathLimits& limits) {
  double speed = KinematicPathLimits::kNone;
  const Vector3 turn = after.first - before.first;
  if (turn.norm() > geometry::kSameDirection) speed = speed_for(turn, speed_jump(limits));
  const Vector3 bend = after.second - before.second;
  const double scale = std::max(before.second.norm(), after.second.norm());
  if (bend.norm() > geometry::kSameDirection * scale) {
    speed = std::min(speed, std::sqrt(speed_for(bend, acceleration_jump(limits))));
  }
  return speed;
}

}  // namespace batten::postproc
