// grbl 1.1: straight blocks only, junction deviation, trapezoids, a short queue.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/basic/rounding.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Vector3;

// How many chords grbl cuts an arc into: as many as fit when each chord has its whole
// deviation on the inside, floor(angle r / 2 / sqrt(t (2r - t))), at least one.
int chords_of(const geometry::Arc& arc, double tolerance) {
  const Vector3 from = arc.start - arc.center;
  const double radius = (from - arc.axis.dot(from) * arc.axis).norm();
  const double half_chord = std::sqrt(tolerance * std::max(tolerance, 2 * radius - tolerance));
  return std::max(1, static_cast<int>(std::abs(arc.sweep) * radius / 2 / half_chord));
}

// A Bezier piece never reaches grbl; it is timed as the chords within the same tolerance.
int chords_of(const geometry::PathPiece& piece, double tolerance) {
  if (const auto* arc = std::get_if<geometry::Arc>(&piece)) return chords_of(*arc, tolerance);
  if (std::holds_alternative<geometry::Line>(piece)) return 1;
  const double bound = geometry::second_derivative_bound(piece);
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(bound / 8 / tolerance))));
}

}  // namespace

StretchChain grbl_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                            gcode::PathMode path, WithPositions places) {
  StretchChain chain;
  // The block that runs stays in the planner until it has ended: beyond the joint after it there is
  // one block less.
  chain.rules.look_ahead = std::max(1, machine.look_ahead - 1);
  const Vector3 acceleration = axis_accelerations(machine);
  std::optional<Vector3> before;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const TimedPiece& timed = pieces[i];
    const double length = geometry::length_of(timed.piece);
    const double velocity =
        std::min({timed.feed / 60, machine.path_feed, length / machine.block_period});
    const Vector3 axis_velocity = axis_velocities(machine, timed.rapid);
    const int chords = chords_of(timed.piece, machine.arc_tolerance);
    Point3 to = geometry::start_point(timed.piece);
    for (int k = 1; k <= chords; ++k) {
      const Point3 from = std::exchange(to, geometry::point_at(timed.piece, double(k) / chords));
      const Vector3 way = to - from;
      if (way.norm() <= geometry::kSamePlace) continue;
      const Vector3 direction = way.normalized();
      if (before) {
        const bool stops = path == gcode::PathMode::kExactStop && k == 1;
        chain.stretches.back().exit_velocity =
            stops ? 0
                  : junction_deviation_speed(*before, direction, machine.junction_deviation,
                                             acceleration);
      }
      before = direction;
      VelocityStretch s;
      s.length = way.norm();
      s.max_velocity = std::min(velocity, limit_along(direction, axis_velocity));
      s.acceleration = std::min(limit_along(direction, acceleration), machine.path_acceleration);
      chain.stretches.push_back(s);
      if (places == WithPositions::kNo) continue;
      const auto index = static_cast<std::uint32_t>(i);
      chain.places.push_back({index, index, false, geometry::Line{from, to}});
    }
  }
  return chain;
}

}  // namespace batten::postproc
