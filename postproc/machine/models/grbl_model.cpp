// grbl 1.1, grblHAL, Marlin: straight blocks only, between ends on whole steps; junction deviation,
// trapezoids, a queue.
#include <algorithm>
#include <cmath>
#include <numbers>
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

// The sweep of an arc as grbl computes it, in single precision: the rounded ends of a full circle
// differ by about its last digit, and the angle between them is taken for the arc itself where it
// is above 5e-7 and of the right sign. Nothing moves then. Only arcs whose ends nearly meet are in
// danger. In the plane of the axes a and b.
double sweep_in_single_precision(const geometry::Arc& arc) {
  constexpr double kNearlyFull = 1e-3;  // radians from a full turn, or from none
  constexpr float kLeastAngle = 5e-7F;
  const double turn = 2 * std::numbers::pi;
  const double size = std::abs(arc.sweep);
  if (size > kNearlyFull && size < turn - kNearlyFull) return arc.sweep;
  Eigen::Index along = 0;
  if (arc.axis.cwiseAbs().maxCoeff(&along) < 1) return arc.sweep;
  const auto from_center = [&](Eigen::Index i) {
    const auto position = static_cast<float>(arc.start[i]);
    const auto offset = static_cast<float>(arc.center[i] - arc.start[i]);
    const float center = position + offset;
    return std::pair(-offset, static_cast<float>(arc.end[i]) - center);
  };
  const auto [start_a, end_a] = from_center((along + 1) % 3);
  const auto [start_b, end_b] = from_center((along + 2) % 3);
  float angle = std::atan2(start_a * end_b - start_b * end_a, start_a * end_a + start_b * end_b);
  const double sign = arc.axis[along];
  if (arc.sweep * sign < 0) {
    if (angle >= -kLeastAngle) angle -= static_cast<float>(turn);
  } else if (angle <= kLeastAngle) {
    angle += static_cast<float>(turn);
  }
  return angle * sign;
}

// Marlin: so many in a circle, none longer or shorter than its limits (mm); MIN_CIRCLE_SEGMENTS,
// MAX_ARC_SEGMENT_MM, MIN_ARC_SEGMENT_MM as they come.
int marlin_chords_of(const geometry::Arc& arc) {
  constexpr double kOfCircle = 72;
  constexpr double kLongest = 1;
  constexpr double kShortest = 0.1;
  const double wished = 2 * std::numbers::pi * geometry::radius_of(arc) / kOfCircle;
  const double length = std::clamp(wished, kShortest, kLongest);
  return std::max(1, static_cast<int>(geometry::length_of(arc) / length));
}

// A Bezier piece never reaches grbl; it is timed as the chords within the same tolerance.
int chords_of(const geometry::PathPiece& piece, const Machine& machine) {
  const double tolerance = machine.arc_tolerance;
  if (const auto* arc = std::get_if<geometry::Arc>(&piece)) {
    const bool is_marlin = machine.model == ControllerModel::kMarlin;
    return is_marlin ? marlin_chords_of(*arc) : chords_of(*arc, tolerance);
  }
  if (std::holds_alternative<geometry::Line>(piece)) return 1;
  const double bound = geometry::second_derivative_bound(piece);
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(bound / 8 / tolerance))));
}

// How fast joints are passed, mm/s.
class JointSpeed {
 public:
  explicit JointSpeed(const Machine& machine)
      : deviation_(machine.junction_deviation),
        is_marlin_(machine.model == ControllerModel::kMarlin),
        acceleration_(axis_accelerations(machine)) {
    for (std::size_t i = 0; i < kLinearAxes; ++i) {
      steps_[static_cast<Eigen::Index>(i)] = machine.axes[i].velocity_step;
    }
  }

  // `length`: mm, of the block after the joint.
  [[nodiscard]] double between(const Vector3& before, const Vector3& after, double length) const {
    if (!is_marlin_) {
      return junction_deviation_speed(before, after, deviation_, acceleration_);
    }
    if (steps_.allFinite()) {
      const Vector3 change = after - before;
      return change.norm() > geometry::kSameDirection ? limit_along(change, steps_) : kNoLimit;
    }
    return std::min(junction_deviation_speed(before, after, deviation_, acceleration_),
                    of_short_block(before, after, length));
  }

 private:
  // Marlin's rule for blocks below 1 mm that turn by less than 45 degrees: as on the circle that
  // has such chords.
  [[nodiscard]] double of_short_block(const Vector3& before, const Vector3& after,
                                      double length) const {
    constexpr double kShort = 1;  // mm
    const double cosine = before.dot(after);
    const double turn = std::atan2(before.cross(after).norm(), cosine);
    if (length >= kShort || cosine <= std::numbers::sqrt2 / 2 || turn <= geometry::kSameDirection) {
      return kNoLimit;
    }
    const Vector3 across = (after - before).normalized();
    return std::sqrt(length * limit_along(across, acceleration_) / turn);
  }

  double deviation_;
  bool is_marlin_;
  Vector3 acceleration_;
  Vector3 steps_;
};

// Where a move ends: on whole steps of each axis, half of one away from zero.
class StepGrid {
 public:
  explicit StepGrid(const Machine& machine) {
    for (std::size_t i = 0; i < kLinearAxes; ++i) {
      steps_[static_cast<Eigen::Index>(i)] = machine.axes[i].steps;
      is_there_ = is_there_ || std::isfinite(machine.axes[i].steps);
    }
  }

  [[nodiscard]] Point3 nearest(const Point3& point) const {
    if (!is_there_) return point;
    Point3 on_grid = point;
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (std::isfinite(steps_[i])) on_grid[i] = std::round(point[i] * steps_[i]) / steps_[i];
    }
    return on_grid;
  }

 private:
  Vector3 steps_;
  bool is_there_ = false;
};

}  // namespace

StretchChain grbl_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                            const gcode::PathControl& path, WithPositions places) {
  StretchChain chain;
  // The block that runs stays in the planner until it has ended: beyond the joint after it there is
  // one block less.
  chain.rules.look_ahead = std::max(1, machine.look_ahead - 1);
  const Vector3 acceleration = axis_accelerations(machine);
  const StepGrid grid(machine);
  const JointSpeed joint(machine);
  const bool single_precision = machine.model == ControllerModel::kGrbl;
  std::optional<Vector3> before;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const TimedPiece& timed = pieces[i];
    const double length = geometry::length_of(timed.piece);
    const double velocity =
        std::min({timed.feed / 60, machine.path_feed, length / machine.block_period});
    const Vector3 axis_velocity = axis_velocities(machine, timed.rapid);
    geometry::PathPiece as_computed;
    const auto* arc = std::get_if<geometry::Arc>(&timed.piece);
    if (arc != nullptr && single_precision) {
      as_computed = *arc;
      std::get<geometry::Arc>(as_computed).sweep = sweep_in_single_precision(*arc);
    }
    const geometry::PathPiece& piece =
        arc != nullptr && single_precision ? as_computed : timed.piece;
    const int chords = chords_of(piece, machine);
    Point3 to = grid.nearest(geometry::start_point(timed.piece));
    for (int k = 1; k <= chords; ++k) {
      const Point3 from =
          std::exchange(to, grid.nearest(geometry::point_at(piece, double(k) / chords)));
      const Vector3 way = to - from;
      if (way.norm() <= geometry::kSamePlace) continue;
      const Vector3 direction = way.normalized();
      if (before) {
        const bool stops = path.mode == gcode::PathMode::kExactStop && k == 1;
        chain.stretches.back().exit_velocity =
            stops ? 0 : joint.between(*before, direction, way.norm());
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
