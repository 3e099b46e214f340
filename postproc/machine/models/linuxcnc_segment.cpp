#include "postproc/machine/models/linuxcnc_segment.h"

#include <algorithm>
#include <cmath>

#include "geometry/basic/rounding.h"
#include "postproc/machine/models/junction_speed.h"

namespace batten::postproc::linuxcnc {
namespace {

using geometry::Vector3;

// Curvature below this (1/mm) bends a metre of path by less than 1e-4 mm: a line.
constexpr double kNoCurvature = 1e-9;

double greatest_curvature(const geometry::PathPiece& piece) {
  double most = 0;
  for (const double t : {0.0, 0.5, 1.0}) most = std::max(most, geometry::curvature_at(piece, t));
  return most;
}

// The speed of the peak when a move of this length starts and ends at rest.
double triangle_velocity(double acceleration, double length) {
  return std::sqrt(acceleration * length);
}

// What the axes can do while they turn through all directions of a bend.
struct BendLimits {
  double velocity = 0;      // mm/s
  double acceleration = 0;  // mm/s^2
};

// Limits on a bend of radius r in its plane; a helix has the speed and acceleration of its
// projection. The control takes r + h^2 / r for the radius of curvature, with h the whole
// rise of the move and not the rise per radian, so that steep helices speed up faster.
void set_bend(Segment& s, double radius, double rise, double flat_length,
              const BendLimits& limits) {
  const double stretch = s.length / flat_length;
  s.shape = Shape::kArc;
  s.radius = radius;
  s.speed_radius = radius + rise * rise / radius;
  s.acceleration = limits.acceleration * stretch;
  s.max_velocity =
      std::min(limits.velocity, std::sqrt(kNormalShare * limits.acceleration * radius)) * stretch;
  s.sweep = flat_length / radius;
}

// The third axis limits a helix by its share of the way.
void limit_by_rise(Segment& s, const Vector3& rise, const Vector3& velocity,
                   const Vector3& acceleration) {
  if (rise.norm() <= geometry::kSamePlace) return;
  const Vector3 share = rise / s.length;
  s.max_velocity = std::min(s.max_velocity, limit_along(share, velocity));
  s.acceleration = std::min(s.acceleration, limit_along(share, acceleration));
}

void set_arc(Segment& s, const geometry::Arc& arc, const Vector3& velocity,
             const Vector3& acceleration) {
  const double rise = arc.axis.dot(arc.end - arc.start);
  const Vector3 start = arc.start - arc.center;
  const Vector3 end = arc.end - arc.center;
  const double r0 = (start - arc.axis.dot(start) * arc.axis).norm();
  const double r1 = (end - arc.axis.dot(end) * arc.axis).norm();
  const double flat_length = std::sqrt(std::max(0.0, s.length * s.length - rise * rise));
  set_bend(s, std::min(r0, r1), rise, flat_length,
           {limit_across(arc.axis, velocity), limit_across(arc.axis, acceleration)});
  limit_by_rise(s, rise * arc.axis, velocity, acceleration);
  s.axis = arc.sweep > 0 ? arc.axis : Vector3(-arc.axis);
  s.sweep = std::abs(arc.sweep);
}

void set_straight(Segment& s, const Vector3& velocity, const Vector3& acceleration) {
  s.max_velocity = limit_along(s.start_direction, velocity);
  s.acceleration = limit_along(s.start_direction, acceleration);
}

void set_line(Segment& s, const geometry::Line& line, const Vector3& velocity,
              const Vector3& acceleration) {
  const Vector3 way = line.end - line.start;
  s.length = s.nominal_length = way.norm();
  if (s.length > 0) s.start_direction = way / s.length;
  s.end_direction = s.start_direction;
  set_straight(s, velocity, acceleration);
}

void set_bent(Segment& s, const geometry::PathPiece& piece, const Vector3& velocity,
              const Vector3& acceleration) {
  s.length = s.nominal_length = geometry::length_of(piece);
  s.start_direction = geometry::direction_at(piece, 0);
  s.end_direction = geometry::direction_at(piece, 1);
  const double curvature = greatest_curvature(piece);
  if (curvature <= kNoCurvature) {
    set_straight(s, velocity, acceleration);
  } else if (const auto* arc = std::get_if<geometry::Arc>(&piece)) {
    set_arc(s, *arc, velocity, acceleration);
  } else {
    set_bend(s, 1 / curvature, 0, s.length, {velocity.minCoeff(), acceleration.minCoeff()});
  }
}

}  // namespace

SpaceLimits space_limits(const Machine& machine) {
  return {axis_velocities(machine, false), axis_velocities(machine, true),
          axis_accelerations(machine), machine.path_feed,
          std::max(machine.block_period, machine.servo_period)};
}

Segment segment_of(const TimedPiece& timed, const SpaceLimits& limits, Joint end) {
  Segment s;
  const Vector3& velocity = timed.rapid ? limits.rapid_velocity : limits.velocity;
  s.feed = timed.feed / 60;
  s.end = end;
  if (const auto* line = std::get_if<geometry::Line>(&timed.piece)) {
    set_line(s, *line, velocity, limits.acceleration);
  } else {
    set_bent(s, timed.piece, velocity, limits.acceleration);
  }
  s.max_velocity = std::min({s.max_velocity, limits.path_feed, s.length / limits.period});
  return s;
}

double usable_acceleration(const Segment& s) {
  const double kink = std::max(s.kink_share_at_start, s.kink_share_at_end);
  const bool shared = s.after_parabolic || s.end == Joint::kParabolic;
  return s.acceleration * (1 - kink) * (shared ? 0.5 : 1.0);
}

double tangential_acceleration(const Segment& s) {
  return usable_acceleration(s) * (s.shape == Shape::kLine ? 1.0 : s.tangential_share);
}

double target_velocity(const Segment& s) { return std::min(s.feed, s.max_velocity); }

void finish_segment(Segment& s, double period) {
  // The optimiser leaves 2 % for the rounding of whole periods.
  constexpr double kLeastPeriods = 1.02;
  s.max_velocity = std::min(s.max_velocity, s.length / (period * kLeastPeriods));
  if (s.shape != Shape::kArc) return;
  const double usable = usable_acceleration(s);
  const double steepest = std::sqrt(kNormalShare * usable * s.speed_radius);
  if (s.max_velocity >= steepest) {
    s.max_velocity = steepest;
    s.tangential_share = kTangentialShare;
  } else {
    const double normal = s.max_velocity * s.max_velocity / s.speed_radius / usable;
    s.tangential_share = std::sqrt(1 - normal * normal);
  }
}

double kink_at_full_speed(const Segment& before, const Segment& after, const Vector3& acceleration,
                          double period) {
  const double velocity = std::min(target_velocity(before), target_velocity(after));
  const double step = velocity / period + after.acceleration;
  const Vector3 turn = after.start_direction - before.end_direction;
  const double share = step * turn.cwiseAbs().cwiseQuotient(acceleration).maxCoeff();
  const bool bend = before.shape == Shape::kArc || after.shape == Shape::kArc;
  return bend ? share / kTangentialShare : share;
}

double parabolic_velocity(const Segment& before, const Segment& after, double tolerance) {
  const double a1 = tangential_acceleration(before);
  const double a2 = tangential_acceleration(after);
  const double v1 = std::min(triangle_velocity(a1, before.length / 2), target_velocity(before));
  const double v2 = std::min(triangle_velocity(a2, after.length / 2), target_velocity(after));
  const double longest = std::min(before.length / v1, after.length / v2);
  const double blend_time = std::min(longest, std::max(v1 / a1, v2 / a2));
  double velocity = std::min({v1, blend_time * a1, v2, blend_time * a2});
  // Half the angle between the moves: 90 degrees where the path runs straight on.
  const double cos_half =
      std::sqrt(std::max(0.0, (1 - before.end_direction.dot(after.start_direction)) / 2));
  if (tolerance > 0 && cos_half > 0) {
    velocity = std::min(velocity, 2 * std::sqrt(a1 * tolerance / cos_half));
  }
  return velocity;
}

}  // namespace batten::postproc::linuxcnc
