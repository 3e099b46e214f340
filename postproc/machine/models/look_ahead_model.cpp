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
// bends slow it down, until the speeds that they allow differ by no more than this share.
constexpr int kBezierHalvings = 5;
constexpr double kEvenBend = 0.02;

VelocityStretch line_stretch(const PathPiece& line, const Vector3& velocity, const Machine& m) {
  VelocityStretch s;
  s.max_velocity = limit_on(line, velocity);
  s.acceleration = std::min(limit_on(line, axis_accelerations(m)), m.path_acceleration);
  return s;
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
    s.max_velocity = std::min(s.max_velocity, std::sqrt(kNormalShare * acceleration / curvature));
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

// Whether the curvature of a bend makes it slower than `velocity` somewhere, and less slow
// elsewhere.
bool slows_unevenly(const PathPiece& bend, double velocity, const Machine& m) {
  constexpr int kPlaces = 8;
  double least = geometry::curvature_at(bend, 0);
  double greatest = least;
  for (int i = 1; i <= kPlaces; ++i) {
    const double curvature = geometry::curvature_at(bend, double(i) / kPlaces);
    least = std::min(least, curvature);
    greatest = std::max(greatest, curvature);
  }
  const double acceleration = kNormalShare * limit_on(bend, axis_accelerations(m));
  // The speed that a bend allows goes with the root of its radius.
  return greatest * velocity * velocity > acceleration &&
         least < greatest * (1 - kEvenBend) * (1 - kEvenBend);
}

// Rapids end in position, and so does every block of an exact mode.
bool stops_between(const TimedPiece& before, const TimedPiece& after, gcode::PathMode path) {
  return before.rapid || after.rapid || path == gcode::PathMode::kExactStop ||
         path == gcode::PathMode::kExactPath;
}

}  // namespace

StretchChain look_ahead_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                                  gcode::PathMode path, WithPositions places) {
  StretchChain chain;
  chain.rules.look_ahead = machine.look_ahead;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const PathPiece& piece = pieces[i].piece;
    const Vector3 axis_velocity = axis_velocities(machine, pieces[i].rapid);
    const double velocity = std::min({pieces[i].feed / 60, machine.path_feed,
                                      geometry::length_of(piece) / machine.block_period});
    const auto add = [&](const PathPiece& part, VelocityStretch s) {
      s.length = geometry::length_of(part);
      s.jerk = std::min(limit_on(part, axis_jerks(machine)), machine.path_jerk);
      s.max_velocity = std::min(s.max_velocity, velocity);
      if (!(s.length > 0)) return;
      chain.stretches.push_back(s);
      const auto index = static_cast<std::uint32_t>(i);
      if (places == WithPositions::kYes) chain.places.push_back({index, index, false, part});
    };
    const auto add_bend = [&](const PathPiece& bend, int halvings, const auto& again) -> void {
      if (halvings == 0 || !slows_unevenly(bend, velocity, machine)) {
        return add(bend, bend_stretch(bend, axis_velocity, machine));
      }
      again(geometry::sub_piece(bend, 0, 0.5), halvings - 1, again);
      again(geometry::sub_piece(bend, 0.5, 1), halvings - 1, again);
    };
    if (std::holds_alternative<geometry::Line>(piece)) {
      add(piece, line_stretch(piece, axis_velocity, machine));
    } else {
      const bool cubic = std::holds_alternative<geometry::CubicBezier>(piece);
      add_bend(piece, cubic ? kBezierHalvings : 0, add_bend);
    }
    if (i + 1 == pieces.size()) break;
    chain.stretches.back().exit_velocity =
        stops_between(pieces[i], pieces[i + 1], path)
            ? 0
            : velocity_step_speed(geometry::direction_at(piece, 1),
                                  geometry::direction_at(pieces[i + 1].piece, 0),
                                  axis_accelerations(machine), machine.servo_period);
  }
  return chain;
}

}  // namespace batten::postproc
