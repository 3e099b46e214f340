// Any control: corner speed by the acceleration of the axes, block rate, look-ahead.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "postproc/machine/controller_models.h"
#include "postproc/machine/junction_speed.h"
#include "postproc/machine/velocity_profile.h"

namespace batten::postproc {
namespace {

using geometry::PathPiece;
using geometry::Vector3;

// Share of the acceleration that a bend may take at steady speed. All of it would leave
// nothing to slow down with; sqrt(3)/2 leaves a half.
constexpr double kNormalShare = std::numbers::sqrt3 / 2;

// A Bezier piece runs on as this many parts of constant curvature.
constexpr int kBezierParts = 32;

VelocityStretch line_stretch(const Vector3& direction, const Machine& m) {
  VelocityStretch s;
  s.max_velocity = limit_along(direction, m.max_velocity());
  s.acceleration = limit_along(direction, m.max_acceleration());
  return s;
}

// A bend turns through all directions of its plane, so the limits are those of one axis.
VelocityStretch bend_stretch(double curvature, const Machine& m) {
  VelocityStretch s;
  s.curvature = curvature;
  s.acceleration = m.max_acceleration();
  s.max_velocity = m.max_velocity();
  if (curvature > 0) {
    s.max_velocity =
        std::min(s.max_velocity, std::sqrt(kNormalShare * m.max_acceleration() / curvature));
  }
  return s;
}

double greatest_curvature(const PathPiece& piece) {
  double most = 0;
  for (const double t : {0.0, 0.5, 1.0}) most = std::max(most, geometry::curvature_at(piece, t));
  return most;
}

void add_stretches(const TimedPiece& timed, const Machine& m, std::vector<VelocityStretch>& chain) {
  const double length = geometry::length_of(timed.piece);
  const double velocity = std::min(timed.feed / 60, length / m.block_period);
  const auto add = [&](VelocityStretch s, double part_length) {
    s.length = part_length;
    s.max_velocity = std::min(s.max_velocity, velocity);
    chain.push_back(s);
  };
  if (std::holds_alternative<geometry::Line>(timed.piece)) {
    add(line_stretch(geometry::direction_at(timed.piece, 0), m), length);
  } else if (std::holds_alternative<geometry::Arc>(timed.piece)) {
    add(bend_stretch(greatest_curvature(timed.piece), m), length);
  } else {
    for (int i = 0; i < kBezierParts; ++i) {
      const PathPiece part =
          geometry::sub_piece(timed.piece, double(i) / kBezierParts, double(i + 1) / kBezierParts);
      const double part_length = geometry::length_of(part);
      if (part_length > 0) add(bend_stretch(greatest_curvature(part), m), part_length);
    }
  }
}

}  // namespace

double look_ahead_time(std::span<const TimedPiece> pieces, const Machine& machine,
                       gcode::PathMode path) {
  std::vector<VelocityStretch> chain;
  chain.reserve(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    add_stretches(pieces[i], machine, chain);
    if (i + 1 == pieces.size()) break;
    chain.back().exit_velocity =
        path == gcode::PathMode::kExactStop
            ? 0
            : velocity_step_speed(geometry::direction_at(pieces[i].piece, 1),
                                  geometry::direction_at(pieces[i + 1].piece, 0),
                                  machine.max_acceleration(), machine.block_period);
  }
  ProfileRules rules;
  rules.look_ahead = machine.look_ahead;
  return profile_time(chain, rules);
}

}  // namespace batten::postproc
