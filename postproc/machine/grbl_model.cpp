// grbl 1.1: straight blocks only, junction deviation, trapezoids, a short queue.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "geometry/numeric.h"
#include "postproc/machine/controller_models.h"
#include "postproc/machine/junction_speed.h"
#include "postproc/machine/velocity_profile.h"

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
  Planner(const Machine& machine, bool stops_at_blocks)
      : machine_(machine), stops_at_blocks_(stops_at_blocks) {}

  void add_block(const TimedPiece& timed) {
    const double length = geometry::length_of(timed.piece);
    const double velocity = std::min(timed.feed / 60, length / machine_.block_period);
    const int chords = chords_of(timed.piece, machine_.arc_tolerance);
    Point3 from = geometry::start_point(timed.piece);
    for (int i = 1; i <= chords; ++i) {
      const Point3 to = geometry::point_at(timed.piece, double(i) / chords);
      add_chord(to - from, velocity, i == 1);
      from = to;
    }
  }

  [[nodiscard]] double time() const {
    ProfileRules rules;
    rules.look_ahead = machine_.look_ahead;
    return profile_time(chain_, rules);
  }

 private:
  void add_chord(const Vector3& way, double velocity, bool first_of_block) {
    if (way.norm() <= geometry::kSamePlace) return;
    const Vector3 direction = way.normalized();
    if (before_) {
      chain_.back().exit_velocity =
          stops_at_blocks_ && first_of_block
              ? 0
              : junction_deviation_speed(*before_, direction, machine_.junction_deviation,
                                         machine_.max_acceleration());
    }
    VelocityStretch s;
    s.length = way.norm();
    s.max_velocity = std::min(velocity, limit_along(direction, machine_.max_velocity()));
    s.acceleration = limit_along(direction, machine_.max_acceleration());
    chain_.push_back(s);
    before_ = direction;
  }

  const Machine& machine_;
  bool stops_at_blocks_;
  std::vector<VelocityStretch> chain_;
  std::optional<Vector3> before_;
};

}  // namespace

double grbl_time(std::span<const TimedPiece> pieces, const Machine& machine, gcode::PathMode path) {
  Planner planner(machine, path == gcode::PathMode::kExactStop);
  for (const TimedPiece& timed : pieces) planner.add_block(timed);
  return planner.time();
}

}  // namespace batten::postproc
