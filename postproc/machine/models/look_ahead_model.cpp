// Any control: corner speed by the acceleration of the axes, block rate, look-ahead.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

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

// A Bezier piece runs on as this many parts of constant curvature.
constexpr int kBezierParts = 32;

VelocityStretch line_stretch(const PathPiece& line, const Vector3& velocity, const Machine& m) {
  VelocityStretch s;
  s.max_velocity = limit_on(line, velocity);
  s.acceleration = std::min(limit_on(line, axis_accelerations(m)), m.path_acceleration);
  return s;
}

// A bend turns through all directions of its plane, so the limits are those of one axis.
VelocityStretch bend_stretch(const PathPiece& bend, double curvature, const Vector3& velocity,
                             const Machine& m) {
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

class Chain {
 public:
  Chain(const Machine& machine, WithPositions places) : machine_(machine), places_(places) {}

  void add(const TimedPiece& timed, std::uint32_t index) {
    const double length = geometry::length_of(timed.piece);
    const Vector3 velocity = axis_velocities(machine_, timed.rapid);
    velocity_ = std::min({timed.feed / 60, machine_.path_feed, length / machine_.block_period});
    if (std::holds_alternative<geometry::Line>(timed.piece)) {
      add_part(line_stretch(timed.piece, velocity, machine_), timed.piece, length, index);
    } else if (std::holds_alternative<geometry::Arc>(timed.piece)) {
      add_part(bend_stretch(timed.piece, greatest_curvature(timed.piece), velocity, machine_),
               timed.piece, length, index);
    } else {
      add_bezier(timed.piece, velocity, index);
    }
  }

  void set_exit_velocity(double velocity) { chain_.stretches.back().exit_velocity = velocity; }

  StretchChain finish() {
    chain_.rules.look_ahead = machine_.look_ahead;
    return std::move(chain_);
  }

 private:
  void add_bezier(const PathPiece& piece, const Vector3& velocity, std::uint32_t index) {
    for (int i = 0; i < kBezierParts; ++i) {
      const PathPiece part =
          geometry::sub_piece(piece, double(i) / kBezierParts, double(i + 1) / kBezierParts);
      const double length = geometry::length_of(part);
      if (length > 0) {
        add_part(bend_stretch(part, greatest_curvature(part), velocity, machine_), part, length,
                 index);
      }
    }
  }

  void add_part(VelocityStretch s, const PathPiece& part, double length, std::uint32_t index) {
    s.length = length;
    s.jerk = std::min(limit_on(part, axis_jerks(machine_)), machine_.path_jerk);
    s.max_velocity = std::min(s.max_velocity, velocity_);
    chain_.stretches.push_back(s);
    if (places_ == WithPositions::kYes) chain_.places.push_back({index, index, false, part});
  }

  const Machine& machine_;
  WithPositions places_;
  double velocity_ = 0;  // mm/s, what the block asks for and its length allows
  StretchChain chain_;
};

// Rapids end in position, and so does every block of an exact mode.
bool stops_between(const TimedPiece& before, const TimedPiece& after, gcode::PathMode path) {
  return before.rapid || after.rapid || path == gcode::PathMode::kExactStop ||
         path == gcode::PathMode::kExactPath;
}

}  // namespace

StretchChain look_ahead_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                                  gcode::PathMode path, WithPositions places) {
  Chain chain(machine, places);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    chain.add(pieces[i], static_cast<std::uint32_t>(i));
    if (i + 1 == pieces.size()) break;
    chain.set_exit_velocity(
        stops_between(pieces[i], pieces[i + 1], path)
            ? 0
            : velocity_step_speed(geometry::direction_at(pieces[i].piece, 1),
                                  geometry::direction_at(pieces[i + 1].piece, 0),
                                  axis_accelerations(machine), machine.servo_period));
  }
  return chain.finish();
}

}  // namespace batten::postproc
