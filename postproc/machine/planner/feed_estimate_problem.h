// The search of the quick estimate: the least time over one stretch, on few nodes.
//
// q = speed^2 is a quadratic spline of the way: q and dq/ds run on, d2q/ds2 is constant over each
// interval. Its unknowns are the Bezier ordinates, q at the start, one in the middle of each
// interval, and q at the end.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_estimate_parts.h"
#include "postproc/machine/planner/feed_plan_envelope.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

struct EstimateInterval {
  std::size_t piece = 0;  // the place whose derivatives stand for the interval
  double t = 0;
  double length = 0;                                // mm
  double speed = 0;                                 // mm/s, roughly, in its middle: a bound
  double inner_bound = KinematicPathLimits::kNone;  // mm/s, the least of the joints inside
  double end_bound = KinematicPathLimits::kNone;    // mm/s, of the joint at its end
};

// How the search begins or ends.
struct EstimateEnd {
  enum class Kind {
    kFree,    // at most `speed`, with any acceleration
    kSlow,    // at `speed`, acceleration 0; the next node is near
    kArc,     // at `speed`, far below that of the next node, `length` mm away: constant jerk
    kMoving,  // at `speed` with `acceleration`
  };
  Kind kind = Kind::kFree;
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2
  double length = 0;        // mm
};

// A stretch between two slow places, or a part of the way of one.
struct EstimateStretch {
  std::vector<EstimateInterval> intervals;
  EstimateEnd start;
  EstimateEnd end;
};

// A node at every place where the machine could have changed its speed: `density` of them in the
// time sqrt(v / jerk). Parts that are shorter than that are joined. `w` is the greatest potential
// at the ends of the parts, one more than parts. Of `start` and `end` kind and speed are given;
// a slow end becomes an arc where the speed soon is much greater.
[[nodiscard]] EstimateStretch make_estimate_stretch(std::span<const EstimatePart> parts,
                                                    std::span<const double> w,
                                                    const Potential& potential,
                                                    const EstimateEnd& start,
                                                    const EstimateEnd& end, double density);

struct EstimateSolution {
  std::vector<double> ordinates;  // one more than intervals and one: see above
  std::vector<double> seconds;    // of each interval
  double start_seconds = 0;       // of the arcs before and after
  double end_seconds = 0;
  bool found = false;  // or the search did not come to an end
};

// The limits are asked for in the middle of each interval and, those of joints, at its end.
[[nodiscard]] EstimateSolution quick_search(std::span<const geometry::PathPiece> path,
                                            const EstimateStretch& stretch,
                                            const KinematicPathLimits& limits);

// Speed and acceleration along the path at a node.
struct EstimateNode {
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2
};

// Between interval `i - 1` and interval `i`.
[[nodiscard]] EstimateNode node_of(const EstimateStretch& stretch, const EstimateSolution& solution,
                                   std::size_t i);

}  // namespace batten::postproc
