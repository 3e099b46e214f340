// How fast a path can be at most, roughly: a bound from its slow places outwards, for choosing
// where a feed plan has its nodes and where its search starts.
//
// From rest with jerk J, v^3 = 4.5 J s^2: in the potential w = v^1.5 this is the straight line
// w = sqrt(4.5 J) s, and from any speed w grows no faster unless the machine already accelerates.
// So the slow places of a path make w a chain of straight slopes, and sqrt(J) / w is the number
// of times per mm that the machine could change its speed altogether. Without a jerk limit the
// same holds for w = v^2, its slope 2 A, and A / w.
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

struct EnvelopeStep {
  std::size_t piece = 0;
  double t0 = 0;
  double t1 = 1;
  double length = 0;  // mm
  double cap = 0;     // w is not above this between its ends
  double slope = 0;   // nor steeper than this
  // How much the shares of the acceleration and jerk limits that steady motion takes change from
  // end to end, in the worst axis: times v^2 and v^3.
  double by_squared_speed = 0;
  double by_cubed_speed = 0;

  // The greatest w between its ends.
  [[nodiscard]] double peak(double w0, double w1) const;
};

struct Envelope {
  std::vector<EnvelopeStep> steps;
  std::vector<double> w;      // at the places between the steps
  std::vector<double> bound;  // mm/s there, as the joints and ends allow
};

// Pieces of some length; `bounds` mm/s at their ends, one more than pieces. The feed and the
// speeds of the axes count 2.5 times: on a straight way the feed alone is no reason for nodes, only
// how near a slow place is.
[[nodiscard]] Envelope speed_envelope(std::span<const geometry::PathPiece> pieces,
                                      std::span<const double> bounds,
                                      const KinematicPathLimits& limits);

}  // namespace batten::postproc
