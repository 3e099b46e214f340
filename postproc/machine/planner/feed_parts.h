// How fast a path can be at most, roughly: a bound from its slow places outwards. It says where a
// feed plan and a quick estimate have their nodes and where their search starts.
//
// From rest with jerk J, v^3 = 4.5 J s^2: in the potential w = v^1.5 this is the straight line
// w = sqrt(4.5 J) s, and from any speed w grows no faster unless the machine already accelerates.
// So the slow places of a path make w a chain of straight slopes, and sqrt(J) / w is the number
// of times per mm that the machine could change its speed altogether. Without a jerk limit the
// same holds for w = v^2, its slope 2 A, and A / w.
//
// The path is cut into parts for that: each bends so little that the derivatives in its middle
// stand for all of it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

class Potential {
 public:
  explicit Potential(const KinematicPathLimits& limits);

  [[nodiscard]] double of_speed(double v) const;
  [[nodiscard]] double speed(double w) const;

  // From rest, w is proportional to s, and v to this power of s.
  [[nodiscard]] double exponent() const { return jerk_limited_ ? 2.0 / 3 : 0.5; }

  // dw/ds along a direction.
  [[nodiscard]] double slope(const geometry::Vector3& direction,
                             const KinematicPathLimits& limits) const;

  // Changes of speed per mm are this times slope / w.
  [[nodiscard]] double rate() const;

 private:
  bool jerk_limited_;
};

// What a joint allows: mm/s; 0: a stop, since the machine reaches more from rest within 1e-6 mm;
// infinity where the path runs on, or where the joint allows what the machine can do at all.
[[nodiscard]] double passing_speed(const LengthDerivatives& before, const LengthDerivatives& after,
                                   const Potential& potential, const KinematicPathLimits& limits);

struct PathPart {
  std::size_t piece = 0;
  double t0 = 0;
  double t1 = 1;
  double length = 0;  // mm
  double cap = 0;     // of the potential: what the bend allows if it were held
  double slope = 0;   // of the potential by mm, the greatest
  double top = 0;     // of the potential, where feed or acceleration end the first phase from rest
  double bend = 0;    // how much the shares of the limits that steady motion takes change over it
  double end_bound = KinematicPathLimits::kNone;  // mm/s, what the joint at its end allows
  bool straight = true;
};

// Derivatives at both ends of a piece.
struct PieceEnds {
  LengthDerivatives start;
  LengthDerivatives end;
};

[[nodiscard]] PieceEnds ends_of(const geometry::PathPiece& piece);

// Appends the parts of `piece`, which is number `number` of its path and of some length.
void append_parts(const geometry::PathPiece& piece, std::size_t number, const PieceEnds& ends,
                  const Potential& potential, const KinematicPathLimits& limits,
                  std::vector<PathPart>& parts);

// Parts that are run without a stop between them, and the greatest potential at their ends.
struct PartChain {
  std::vector<PathPart> parts;
  std::vector<double> w;  // one more than parts

  // The envelope of the speeds, given those at both ends, mm/s.
  void find_potentials(double start_speed, double end_speed, const Potential& potential);

  // The joints, as numbers of the parts before which they are, that are this many times slower than
  // the envelope before and after them.
  [[nodiscard]] std::vector<std::size_t> slow_joints(double times,
                                                     const Potential& potential) const;
};

// The chain of pieces of some length, with their envelope; `bounds`: mm/s at their ends, one more
// than pieces.
[[nodiscard]] PartChain parts_of(std::span<const geometry::PathPiece> pieces,
                                 std::span<const double> bounds, const Potential& potential,
                                 const KinematicPathLimits& limits);

// How the potential may rise and fall over a part between two given ones, above 0.
struct PartRise {
  double w0 = 0;
  double w1 = 0;
  double top = 0;
  double up = 0;    // mm
  double flat = 0;  // mm
  double slope = 0;
  // Natural logarithms of the rise and the fall, and the flat way in the same measure: changes of
  // speed that the machine could make, but for Potential::rate().
  double rising = 0;
  double running = 0;
  double falling = 0;

  PartRise(const PathPart& part, double length, double from, double to);

  [[nodiscard]] double measure() const { return rising + running + falling; }

  // mm from the start of the part to the place before which there is so much of the measure.
  [[nodiscard]] double place(double m) const;

  [[nodiscard]] double potential_at(double s) const;
};

// How high the potential comes from one end of a chain before it falls again.
[[nodiscard]] double first_rise(std::span<const PathPart> parts, std::span<const double> w,
                                bool from_start);

}  // namespace batten::postproc
