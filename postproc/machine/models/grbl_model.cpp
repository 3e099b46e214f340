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

class Planner {
 public:
  Planner(const Machine& machine, bool stops_at_blocks, WithPositions places)
      : machine_(machine), stops_at_blocks_(stops_at_blocks), places_(places) {}

  void add_block(const TimedPiece& timed, std::uint32_t index) {
    const double length = geometry::length_of(timed.piece);
    const double velocity =
        std::min({timed.feed / 60, machine_.path_feed, length / machine_.block_period});
    const Vector3 axis_velocity = axis_velocities(machine_, timed.rapid);
    const int chords = chords_of(timed.piece, machine_.arc_tolerance);
    Point3 from = geometry::start_point(timed.piece);
    for (int i = 1; i <= chords; ++i) {
      const Point3 to = geometry::point_at(timed.piece, double(i) / chords);
      if (add_chord(to - from, velocity, axis_velocity, i == 1) && places_ == WithPositions::kYes) {
        chain_.places.push_back({index, index, false, geometry::Line{from, to}});
      }
      from = to;
    }
  }

  StretchChain finish() {
    // The block that runs stays in the planner until it has ended: beyond the joint after it there
    // is one block less.
    chain_.rules.look_ahead = std::max(1, machine_.look_ahead - 1);
    return std::move(chain_);
  }

 private:
  // False where the chord has no length.
  bool add_chord(const Vector3& way, double velocity, const Vector3& axis_velocity,
                 bool first_of_block) {
    if (way.norm() <= geometry::kSamePlace) return false;
    const Vector3 direction = way.normalized();
    if (before_) {
      chain_.stretches.back().exit_velocity =
          stops_at_blocks_ && first_of_block
              ? 0
              : junction_deviation_speed(*before_, direction, machine_.junction_deviation,
                                         axis_accelerations(machine_));
    }
    VelocityStretch s;
    s.length = way.norm();
    s.max_velocity = std::min(velocity, limit_along(direction, axis_velocity));
    s.acceleration =
        std::min(limit_along(direction, axis_accelerations(machine_)), machine_.path_acceleration);
    chain_.stretches.push_back(s);
    before_ = direction;
    return true;
  }

  const Machine& machine_;
  bool stops_at_blocks_;
  WithPositions places_;
  StretchChain chain_;
  std::optional<Vector3> before_;
};

}  // namespace

StretchChain grbl_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                            gcode::PathMode path, WithPositions places) {
  Planner planner(machine, path == gcode::PathMode::kExactStop, places);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    planner.add_block(pieces[i], static_cast<std::uint32_t>(i));
  }
  return planner.finish();
}

}  // namespace batten::postproc
