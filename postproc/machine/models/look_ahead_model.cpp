// Any control: corner speed by the acceleration of the axes, block rate, look-ahead.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

// Share of the acceleration that a bend may take at steady speed. All of it would leave
// nothing to slow down with; sqrt(3)/2 leaves a half.
constexpr double kNormalShare = std::numbers::sqrt3 / 2;

// A Bezier piece runs on as parts of constant curvature: it is halved at most so often where its
// bends slow it down, until the speeds that they allow differ by no more than this share. Under a
// limit on jerk the speed changes over longer ways than those of its finest bends.
struct BezierRule {
  int halvings = 5;
  double even = 0.02;
};
constexpr BezierRule kByAcceleration = {};
constexpr BezierRule kByJerk = {.halvings = 3, .even = 0.2};

bool has_jerk_limit(const Machine& m) { return std::isfinite(std::min(m.max_jerk(), m.path_jerk)); }

VelocityStretch line_stretch(const PathPiece& line, const Vector3& velocity, const Machine& m) {
  VelocityStretch s;
  s.max_velocity = limit_on(line, velocity);
  s.acceleration = std::min(limit_on(line, axis_accelerations(m)), m.path_acceleration);
  return s;
}

// The speeds, mm/s, at which a bend could be run on, where that is slowest and where it is fastest:
// at so many places and at its start.
struct HeldSpeeds {
  double least = kNoLimit;
  double greatest = 0;
};

HeldSpeeds held_speeds(const PathPiece& bend, int places, const Machine& m) {
  const double acceleration = kNormalShare * limit_on(bend, axis_accelerations(m));
  const Vector3 jerks = axis_jerks(m);
  const bool has_jerk = jerks.minCoeff() < kNoLimit;
  const bool arc = std::holds_alternative<geometry::Arc>(bend);
  const double of_arc = arc ? limit_on(bend, jerks) : kNoLimit;
  HeldSpeeds held;
  for (int i = 0; i <= places; ++i) {
    const double t = double(i) / places;
    const double curvature = geometry::curvature_at(bend, t);
    double speed = curvature > 0 ? std::sqrt(acceleration / curvature) : kNoLimit;
    if (has_jerk) {
      // At steady speed the jerk is the third derivative times the cube of the speed: on an arc the
      // square of the curvature, along every direction of its plane.
      const double share =
          arc ? curvature * curvature / of_arc
              : derivatives_by_length(bend, t).third.cwiseQuotient(jerks).cwiseAbs().maxCoeff();
      if (share > 0) speed = std::min(speed, 1 / std::cbrt(share));
    }
    held.least = std::min(held.least, speed);
    held.greatest = std::max(held.greatest, speed);
  }
  return held;
}

// A bend turns through all directions of its plane, so the limits are those of one axis.
VelocityStretch bend_stretch(const PathPiece& bend, const Vector3& velocity, const Machine& m) {
  const double curvature = greatest_curvature(bend);
  const double acceleration = limit_on(bend, axis_accelerations(m));
  VelocityStretch s;
  s.curvature = curvature;
  s.acceleration = acceleration;
  s.max_velocity = limit_on(bend, velocity);
  if (curvature > 0) {
    s.max_velocity = std::min(s.max_velocity, held_speeds(bend, 2, m).least);
  }
  if (m.path_acceleration < acceleration) {
    // Along the bend there is this much or what the normal part leaves at the greatest speed.
    const double normal = curvature * s.max_velocity * s.max_velocity;
    s.acceleration =
        std::min(m.path_acceleration, std::sqrt(acceleration * acceleration - normal * normal));
    s.curvature = 0;
  }
  return s;
}

// Whether a bend is slower than `velocity` somewhere, and less slow elsewhere.
bool slows_unevenly(const PathPiece& bend, double velocity, double even, const Machine& m) {
  constexpr int kPlaces = 8;
  const HeldSpeeds held = held_speeds(bend, kPlaces, m);
  return held.least < velocity && held.least < held.greatest * (1 - even);
}

// mm, of the first of them and those that go on from it.
double length_of_block(std::span<const TimedPiece> pieces) {
  double length = geometry::length_of(pieces.front().piece);
  for (const TimedPiece& piece : pieces.subspan(1)) {
    if (!piece.goes_on) break;
    length += geometry::length_of(piece.piece);
  }
  return length;
}

// mm/s, at a joint that is not a stop. Jerk across the path, at kinks and where the curvature
// jumps, is what a plan of the axes makes of it; without a limit on jerk only the speed of the axes
// counts.
double joint_velocity(const TimedPiece& before, const TimedPiece& after, const Machine& m) {
  if (!has_jerk_limit(m)) {
    return velocity_step_speed(geometry::direction_at(before.piece, 1),
                               geometry::direction_at(after.piece, 0), axis_accelerations(m),
                               m.servo_period);
  }
  return joint_speed(derivatives_by_length(before.piece, 1), derivatives_by_length(after.piece, 0),
                     kinematic_limits(m, after.feed, after.rapid));
}

}  // namespace

StretchChain look_ahead_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                                  const gcode::PathControl& path, WithPositions places) {
  StretchChain chain;
  chain.rules.look_ahead = machine.look_ahead;
  const bool all_stop = stops_at_block_ends(machine, path);
  const bool by_jerk = has_jerk_limit(machine);
  const BezierRule& rule = by_jerk ? kByJerk : kByAcceleration;
  double block_length = 0;  // mm
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const PathPiece& piece = pieces[i].piece;
    const Vector3 axis_velocity = axis_velocities(machine, pieces[i].rapid);
    if (i == 0 || !pieces[i].goes_on) block_length = length_of_block(pieces.subspan(i));
    const double velocity =
        std::min({pieces[i].feed / 60, machine.path_feed, block_length / machine.block_period});
    const auto add = [&](const PathPiece& part, VelocityStretch s) {
      s.length = geometry::length_of(part);
      s.jerk = std::min(mean_limit_on(part, axis_jerks(machine)), machine.path_jerk);
      s.max_velocity = std::min(s.max_velocity, velocity);
      if (!(s.length > 0)) return;
      if (by_jerk && std::holds_alternative<geometry::CubicBezier>(part)) {
        const double at_feed = std::min(velocity, limit_on(part, axis_velocity));
        chain.in_slow_curves += s.length / s.max_velocity - s.length / at_feed;
      }
      chain.stretches.push_back(s);
      const auto index = static_cast<std::uint32_t>(i);
      if (places == WithPositions::kYes) chain.places.push_back({index, index, false, part});
    };
    const auto add_bend = [&](const PathPiece& bend, int halvings, const auto& again) -> void {
      if (halvings == 0 || !slows_unevenly(bend, velocity, rule.even, machine)) {
        return add(bend, bend_stretch(bend, axis_velocity, machine));
      }
      again(geometry::sub_piece(bend, 0, 0.5), halvings - 1, again);
      again(geometry::sub_piece(bend, 0.5, 1), halvings - 1, again);
    };
    if (std::holds_alternative<geometry::Line>(piece)) {
      add(piece, line_stretch(piece, axis_velocity, machine));
    } else {
      const bool cubic = std::holds_alternative<geometry::CubicBezier>(piece);
      add_bend(piece, cubic ? rule.halvings : 0, add_bend);
    }
    if (i + 1 == pieces.size()) break;
    // Rapids end in position.
    const bool stops =
        (all_stop && !pieces[i + 1].goes_on) || pieces[i].rapid || pieces[i + 1].rapid;
    chain.stretches.back().exit_velocity =
        stops ? 0 : joint_velocity(pieces[i], pieces[i + 1], machine);
  }
  return chain;
}

}  // namespace batten::postproc
