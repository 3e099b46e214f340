// Klipper: straight moves only, corners by square corner velocity and by the room of their sides,
// speeds smoothed by the minimum cruise ratio, an endless look-ahead.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "geometry/basic/rounding.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {
namespace {

using geometry::Point3;
using geometry::Vector3;

// Klipper plans in squares of speeds, mm^2/s^2: over a length d and at an acceleration a the square
// changes by 2 a d.
struct KlipperMove {
  Vector3 direction;
  double acceleration = 0;   // mm/s^2
  double change = 0;         // of the square that its length allows
  double smooth_change = 0;  // the same at the acceleration of smoothed speeds
  double greatest = 0;       // the square of its speed limit
  // Squares at its start: what corners and the moves before it allow, of true and of smoothed
  // speed.
  double start_limit = 0;
  double smooth_limit = 0;
  // The plan.
  double start = 0;
  double cruise = 0;  // 0: as the move before it
};

// What holds for every move of a machine.
struct KlipperLimits {
  explicit KlipperLimits(const Machine& m)
      : velocity(std::min({m.path_feed, m.axis(Axis::kX).velocity, m.axis(Axis::kY).velocity})),
        acceleration(std::min(
            {m.path_acceleration, m.axis(Axis::kX).acceleration, m.axis(Axis::kY).acceleration})),
        z_velocity(m.axis(Axis::kZ).velocity),
        z_acceleration(m.axis(Axis::kZ).acceleration),
        corner_deviation(m.square_corner_velocity * m.square_corner_velocity *
                         (std::numbers::sqrt2 - 1) / acceleration),
        smooth_share(1 - m.minimum_cruise_ratio) {}

  double velocity;          // mm/s
  double acceleration;      // mm/s^2
  double z_velocity;        // of the Z part of a move
  double z_acceleration;    // the same
  double corner_deviation;  // mm: as grbl's junction deviation
  double smooth_share;      // of the acceleration, for smoothed speeds
};

KlipperMove move_of(const Vector3& way, double length, double feed, const KlipperLimits& limits) {
  KlipperMove move;
  move.direction = way / length;
  double velocity = std::min(feed, limits.velocity);
  move.acceleration = limits.acceleration;
  const double rise = std::abs(move.direction.z());
  if (rise > 0) {
    velocity = std::min(velocity, limits.z_velocity / rise);
    move.acceleration = std::min(move.acceleration, limits.z_acceleration / rise);
  }
  move.greatest = velocity * velocity;
  move.change = 2 * length * move.acceleration;
  move.smooth_change =
      std::min(move.change, 2 * length * limits.acceleration * limits.smooth_share);
  return move;
}

// The square of the speed at which the corner of two moves may be passed. The circle that rounds it
// is at most `deviation` beside the corner, and touches each move before its middle.
double corner_square(const KlipperMove& before, const KlipperMove& after, double deviation) {
  // With psi the angle between the two (pi: straight on), half of it: sine and cosine.
  const double cosine = (after.direction - before.direction).norm() / 2;
  const double sine = (after.direction + before.direction).norm() / 2;
  if (!(cosine > geometry::kSameDirection)) return kNoLimit;
  const double by_deviation = deviation * std::min(before.acceleration, after.acceleration) * sine *
                              (1 + sine) / (cosine * cosine);
  const double by_room = std::min(before.change, after.change) * sine / (4 * cosine);
  return std::min(by_deviation, by_room);
}

void limit_start(const KlipperMove& before, KlipperMove& move, double corner) {
  move.start_limit =
      std::min({move.greatest, before.greatest, before.start_limit + before.change, corner});
  move.smooth_limit = std::min(move.start_limit, before.smooth_limit + before.smooth_change);
}

// From the last move backwards: each starts as fast as the path can still be met at the end. A
// second plan with the smoothed acceleration says how fast the fastest moves run: where it both
// speeds up and slows down within a move, or from one move to the next, half way between.
void plan(std::vector<KlipperMove>& moves) {
  double next_start = 0;
  double next_smooth = 0;
  double peak = 0;
  bool runs_on = false;  // do moves behind this one wait for its speed?
  for (std::size_t i = moves.size(); i-- > 0;) {
    KlipperMove& move = moves[i];
    const double reachable = next_start + move.change;
    const double smooth_reachable = next_smooth + move.smooth_change;
    const double smooth = std::min(move.smooth_limit, smooth_reachable);
    move.start = std::min(move.start_limit, reachable);
    move.cruise = 0;
    if (smooth < smooth_reachable) {
      if (smooth + move.smooth_change > next_smooth || runs_on) {
        peak = (smooth + smooth_reachable) / 2;
      }
      move.cruise = std::min({(move.start + reachable) / 2, move.greatest, peak});
      runs_on = false;
    } else {
      runs_on = true;
    }
    next_start = move.start;
    next_smooth = smooth;
  }
  double before = 0;
  for (KlipperMove& move : moves) {
    if (move.cruise == 0) move.cruise = std::min(before, move.start);
    before = move.cruise;
  }
}

// The chords of an arc, as many as whole resolutions go into its length.
int chords_at(const geometry::PathPiece& piece, double resolution) {
  if (std::holds_alternative<geometry::Line>(piece)) return 1;
  return std::max(1, static_cast<int>(geometry::length_of(piece) / resolution));
}

// Where the ends of an arc meet, rounding decides on a full turn or none: an angle of 0 is a full
// turn, one of some 1e-16 against the direction of the arc too, with it nothing moves. The offsets
// count as they are printed, with up to six decimals.
bool is_lost(const geometry::Arc& arc) {
  constexpr double kDecimals = 1e6;
  constexpr double kFull = 2 * std::numbers::pi - 1e-6;
  Eigen::Index along = 0;
  if (std::abs(arc.sweep) < kFull || arc.axis.cwiseAbs().maxCoeff(&along) < 1) return false;
  const auto from_center = [&](Eigen::Index i) {
    const double offset = std::round((arc.center[i] - arc.start[i]) * kDecimals) / kDecimals;
    return std::pair(-offset, arc.end[i] - (arc.start[i] + offset));
  };
  const auto [start_a, end_a] = from_center((along + 1) % 3);
  const auto [start_b, end_b] = from_center((along + 2) % 3);
  const double angle =
      std::atan2(start_a * end_b - start_b * end_a, start_a * end_a + start_b * end_b);
  return angle * arc.sweep * arc.axis[along] > 0;
}

}  // namespace

StretchChain klipper_stretches(std::span<const TimedPiece> pieces, const Machine& machine,
                               const gcode::PathControl& path, WithPositions places) {
  const KlipperLimits limits(machine);
  StretchChain chain;
  std::vector<KlipperMove> moves;
  moves.reserve(pieces.size());
  chain.stretches.reserve(pieces.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const geometry::PathPiece& piece = pieces[i].piece;
    const auto* arc = std::get_if<geometry::Arc>(&piece);
    if (arc != nullptr && is_lost(*arc)) continue;
    const double feed =
        std::min(pieces[i].feed / kMinute, geometry::length_of(piece) / machine.block_period);
    const int chords = chords_at(piece, machine.arc_resolution);
    Point3 to = geometry::start_point(piece);
    for (int k = 1; k <= chords; ++k) {
      const Point3 from = to;
      to = k == chords ? geometry::end_point(piece) : geometry::point_at(piece, double(k) / chords);
      const Vector3 way = to - from;
      const double length = way.norm();
      if (length <= geometry::kSamePlace) continue;
      KlipperMove move = move_of(way, length, feed, limits);
      if (!moves.empty() && !(k == 1 && path.mode == gcode::PathMode::kExactStop)) {
        const KlipperMove& before = moves.back();
        limit_start(before, move, corner_square(before, move, limits.corner_deviation));
      }
      moves.push_back(move);
      VelocityStretch s;
      s.length = length;
      s.acceleration = move.acceleration;
      chain.stretches.push_back(s);
      if (places == WithPositions::kNo) continue;
      const auto index = static_cast<std::uint32_t>(i);
      chain.places.push_back({index, index, false, geometry::Line{from, to}});
    }
  }
  plan(moves);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    VelocityStretch& s = chain.stretches[i];
    s.max_velocity = std::sqrt(moves[i].cruise);
    if (i + 1 < moves.size()) {
      s.exit_velocity =
          std::sqrt(std::min({moves[i + 1].start, moves[i].cruise, moves[i + 1].cruise}));
    }
  }
  return chain;
}

}  // namespace batten::postproc
