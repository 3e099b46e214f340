#include "postproc/machine/models/linuxcnc_segment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/basic/rounding.h"
#include "postproc/machine/models/junction_speed.h"

namespace batten::postproc::linuxcnc {
namespace {

using geometry::Vector3;

// Curvature below this (1/mm) bends a metre of path by less than 1e-4 mm: a line.
constexpr double kNoCurvature = 1e-9;

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
    set_bend(s, 1 / curvature, 0, s.length,
             {limit_on(piece, velocity), limit_on(piece, acceleration)});
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

namespace {

using geometry::Vector3;
using Vector2 = Eigen::Vector2d;
using std::numbers::pi;

// Turns smaller than this, or nearer to a full reversal, have no blend arc.
constexpr double kLeastAngle = 1e-6;

// Arcs that meet at less than twice 15 degrees are not blended.
constexpr double kLeastArcAngle = pi / 12;

// The plane of the corner is the plane of an arc when their normals are this parallel.
constexpr double kParallel = 1e-6;

// What a corner may take of one of its moves.
struct Reach {
  double length = 0;   // mm at most, on the straight stand-in for the move
  double angle = 0;    // radians of an arc at most
  double closing = 0;  // radians by which an arc that bends into the corner closes the angle
};

// An arc whose centre lies inside the corner bends towards the other move.
bool bends_inward(const Segment& arc, const Vector3& binormal) {
  return arc.axis.dot(binormal) > 0;
}

Reach arc_reach(const Segment& arc, const Vector3& binormal, double half_angle, double share) {
  if (!bends_inward(arc, binormal)) {
    const double angle = std::min(arc.sweep * share, pi / 2);
    return {angle * arc.radius, angle, 0};
  }
  const double angle = std::min(arc.sweep * share, half_angle);
  return {std::sin(angle / 4) * arc.radius, angle, angle / 4};
}

// The corner takes half of each line, and of arcs two thirds of the one before, one third
// of the one after.
Reach reach_before(const Segment& s, const Vector3& binormal, double half_angle) {
  if (s.shape == Shape::kArc) return arc_reach(s, binormal, half_angle, 2.0 / 3);
  return {std::min(s.length, s.nominal_length / 2), 0, 0};
}

Reach reach_after(const Segment& s, const Vector3& binormal, double half_angle) {
  if (s.shape == Shape::kArc) return arc_reach(s, binormal, half_angle, 1.0 / 3);
  return {s.length / 2, 0, 0};
}

bool in_plane(const Segment& s, const Vector3& binormal) {
  return s.shape != Shape::kArc || s.axis.cross(binormal).norm() < kParallel;
}

double blend_tolerance(const Segment& before, const Segment& after, double tolerance) {
  const double quarter = std::min(before.nominal_length, after.nominal_length) / 4;
  return tolerance > 0 ? std::min(tolerance, quarter) : quarter;
}

// One side of the corner in its plane: the corner is the origin, the path before it runs
// along x, the inside of the corner is the side of positive y.
struct Side {
  bool is_arc = false;
  Vector2 forward;    // unit length, direction of travel at the corner
  Vector2 inward;     // unit length, left of it
  Vector2 center;     // arcs only
  double radius = 0;  // arcs only
  double bend = 0;    // arcs only: +1 towards the inside, -1 away
};

Side side_of(const Segment& s, const Vector3& binormal, double heading) {
  Side side;
  side.is_arc = s.shape == Shape::kArc;
  side.forward = Vector2(std::cos(heading), std::sin(heading));
  side.inward = Vector2(-side.forward.y(), side.forward.x());
  if (side.is_arc) {
    side.radius = s.radius;
    side.bend = bends_inward(s, binormal) ? 1 : -1;
    side.center = side.bend * s.radius * side.inward;
  }
  return side;
}

// The circle of radius R that touches a line and an arc: its centre is R inside the
// line, and r - R or r + R from the centre of the arc. Of the two the one nearer to the corner.
std::optional<Vector2> center_at_line_and_arc(const Side& line, const Side& arc, double radius) {
  const double apart = arc.radius - arc.bend * radius;
  const double across = radius - arc.center.dot(line.inward);
  const double square = apart * apart - across * across;
  if (square < 0) return std::nullopt;
  const double middle = arc.center.dot(line.forward);
  const double d1 = middle + std::sqrt(square);
  const double d2 = middle - std::sqrt(square);
  const double d = std::abs(d1) < std::abs(d2) ? d1 : d2;
  return Vector2(d * line.forward + radius * line.inward);
}

std::optional<Vector2> center_at_arcs(const Side& before, const Side& after, double radius) {
  const double apart1 = before.radius - before.bend * radius;
  const double apart2 = after.radius - after.bend * radius;
  const Vector2 between = after.center - before.center;
  const double distance = between.norm();
  if (distance <= geometry::kSamePlace) return std::nullopt;
  const double along = (apart1 * apart1 - apart2 * apart2 + distance * distance) / (2 * distance);
  const double square = apart1 * apart1 - along * along;
  if (square < 0) return std::nullopt;
  const Vector2 x = between / distance;
  const Vector2 y(-x.y(), x.x());
  const Vector2 c1 = before.center + along * x + std::sqrt(square) * y;
  const Vector2 c2 = before.center + along * x - std::sqrt(square) * y;
  return c1.norm() < c2.norm() ? c1 : c2;
}

Vector2 touching_point(const Side& side, const Vector2& center) {
  if (!side.is_arc) return side.forward.dot(center) * side.forward;
  return side.center + side.radius * (center - side.center).normalized();
}

double angle_between(const Vector2& a, const Vector2& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

// Length that the arc takes from the side.
double trim_of(const Side& side, const Vector2& center) {
  if (!side.is_arc) return std::abs(side.forward.dot(center));
  return side.radius * angle_between(-side.center, center - side.center);
}

struct HalfAngle {
  double sine;
  double cosine;
  double tangent;
};

// Of half the angle between two moves: between lines, whose directions are known, no angle is
// needed for it. `theta`: that angle; `along`: product of the directions; `across`: size of their
// cross product.
HalfAngle half_angle_of(double theta, bool lines, double along, double across) {
  if (!lines || along <= 0) return {std::sin(theta), std::cos(theta), std::tan(theta)};
  const double sine = std::sqrt((1 + along) / 2);
  const double cosine = across / (2 * sine);
  return {sine, cosine, sine / cosine};
}

// Of the velocities that both lines allow as vectors from the corner, the chord between their
// tips: how near it comes to the corner is the speed (mm/s) that the arc may have. What one line
// allows is taken as no more than what puts that nearest place between the tips. `along` and
// `across`: products of the directions.
double velocity_on_chord(const Segment& before, const Segment& after, double along, double across) {
  constexpr double kLeastAlong = 0.0314;  // cosine of 0.49 pi
  const double cosine = std::max(along, kLeastAlong);
  const double v1 = std::min(before.max_velocity, after.max_velocity / cosine);
  const double v2 = std::min(after.max_velocity, before.max_velocity / cosine);
  return v1 * v2 * across / (v2 * after.start_direction - v1 * before.end_direction).norm();
}

// The same arc where a side is an arc itself; the radius stays.
bool fit_to_arcs(BlendArc& arc, const Side& before, const Side& after, double allowed) {
  const auto center = before.is_arc && after.is_arc ? center_at_arcs(before, after, arc.radius)
                      : before.is_arc ? center_at_line_and_arc(after, before, arc.radius)
                                      : center_at_line_and_arc(before, after, arc.radius);
  if (!center || center->norm() - arc.radius > allowed) return false;
  arc.turn = angle_between(touching_point(before, *center) - *center,
                           touching_point(after, *center) - *center);
  arc.trim_before = trim_of(before, *center);
  arc.trim_after = trim_of(after, *center);
  return true;
}

}  // namespace

// With theta half the angle between the moves, an arc of radius R touches both lines at
// R / tan(theta) from the corner and passes it at R (1 - sin(theta)) / sin(theta).
std::optional<BlendArc> blend_arc(const Segment& before, const Segment& after,
                                  const Machine& machine, double tolerance) {
  const Vector3 cross = before.end_direction.cross(after.start_direction);
  const double along = before.end_direction.dot(after.start_direction);
  const double across = cross.norm();
  const double turn = std::atan2(across, along);
  if (turn < 2 * kLeastAngle || pi - turn < 2 * kLeastAngle) return std::nullopt;
  const Vector3 binormal = cross / across;
  if (!in_plane(before, binormal) || !in_plane(after, binormal)) return std::nullopt;

  const double half_angle = (pi - turn) / 2;
  const Reach reach1 = reach_before(before, binormal, half_angle);
  const Reach reach2 = reach_after(after, binormal, half_angle);
  const double theta = half_angle - std::max(reach1.closing, reach2.closing);
  const bool two_arcs = before.shape == Shape::kArc && after.shape == Shape::kArc;
  if (theta <= (two_arcs ? kLeastArcAngle : 0)) return std::nullopt;

  const bool lines = before.shape != Shape::kArc && after.shape != Shape::kArc;
  const HalfAngle half = half_angle_of(theta, lines, along, across);
  BlendArc arc;
  arc.turn = pi - 2 * theta;
  arc.acceleration = limit_across(binormal, axis_accelerations(machine));
  const double normal_acceleration = kNormalShare * arc.acceleration;
  const double allowed = blend_tolerance(before, after, tolerance);
  const double reach =
      std::min({reach1.length, reach2.length, allowed * (1 + half.sine) / half.cosine});
  const double radius = half.tangent * reach;
  const double in_plane_limit = limit_across(binormal, axis_velocities(machine, false));
  const double limit =
      lines ? std::max(in_plane_limit, velocity_on_chord(before, after, along, across))
            : in_plane_limit;
  const double feed = std::min(std::max(target_velocity(before), target_velocity(after)), limit);
  arc.velocity = std::min(std::sqrt(normal_acceleration * radius), feed);

  // The arc is as long as a parabolic blend of the same corner would be, so that long moves
  // lose little of their length.
  const double parabolic = arc.acceleration / 2;
  const double blend_time = std::min(std::sqrt(2 * parabolic * reach), arc.velocity) / parabolic;
  arc.radius = std::max(arc.velocity * arc.velocity / normal_acceleration,
                        std::min(blend_time * arc.velocity / arc.turn, radius));
  arc.trim_before = arc.trim_after = arc.radius / half.tangent;
  if (before.shape == Shape::kArc || after.shape == Shape::kArc) {
    if (!fit_to_arcs(arc, side_of(before, binormal, 0), side_of(after, binormal, turn), allowed)) {
      return std::nullopt;
    }
    if (before.shape == Shape::kArc && arc.trim_before > reach1.angle * before.radius) return {};
    if (after.shape == Shape::kArc && arc.trim_after > reach2.angle * after.radius) return {};
  }
  return arc;
}

}  // namespace batten::postproc::linuxcnc
