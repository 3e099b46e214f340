// The least time in which a machine can run a given path: jerk-limited feed planning.
// Method: docs/algorithms/feed_planning.md.
//
// What jumps is not hidden. At a kink (the direction jumps) the plan stops, unless the jump in
// speed that it makes is within what KinematicPathLimits allows; where the curvature jumps it slows
// down until the acceleration jumps no more than is allowed there. Both are counted.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

// Between two nodes speed^2 is a cubic of the distance; next to rest it is a power of the distance,
// that of constant jerk (of constant acceleration where the jerk has no limit).
struct FeedPlanNode {
  double distance = 0;      // mm from the start of the path
  double speed = 0;         // mm/s
  double acceleration = 0;  // mm/s^2 along the path
  double time = 0;          // s
  std::size_t piece = 0;    // where that is, for the interval that starts here
  double t = 0;
};

struct FeedPlan {
  std::vector<FeedPlanNode> nodes;  // of a path without length: none
  double time = 0;                  // s
  int stops = 0;                    // at kinks, both ends not counted
  int passed_jumps = 0;             // joints passed with an allowed jump in speed or acceleration
};

// No limit is exceeded at the nodes and in the middle between them; between those by some 0.1 %
// and at most 0.5 % with the default density. The time is that of a local optimum (the jerk limit
// is not convex), from above, within a few 1e-4 on the paths whose optimum is known. Linear cost.
//
// Throws std::invalid_argument for limits that are not sound (require_sound) or negative end
// speeds.
[[nodiscard]] FeedPlan plan_feed(std::span<const geometry::PathPiece> path,
                                 const KinematicPathLimits& limits, const PlanEnds& ends = {},
                                 double density = kPlanDensity);

// The same where each piece has limits of its own: a feed, or the speeds of a rapid.
//
// Requires the same limits on jerk, finite or not, on all pieces. Throws std::invalid_argument,
// too, for another number of limits than one or that of the pieces.
[[nodiscard]] FeedPlan plan_feed(std::span<const geometry::PathPiece> path, LimitsOfPieces limits,
                                 const PlanEnds& ends = {}, double density = kPlanDensity);

// How many nodes such a plan begins with on each piece; of a section that is one line, which needs
// no search, one. What it costs, in about. Linear cost. Throws as plan_feed.
[[nodiscard]] std::vector<double> plan_nodes(std::span<const geometry::PathPiece> path,
                                             const KinematicPathLimits& limits,
                                             double density = kPlanDensity);

}  // namespace batten::postproc
