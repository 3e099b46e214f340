// How long the pieces of a chain take by a feed plan, in place of the model of a control: what a
// control could do that looks ahead without end and knows nothing but the limits of the machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/timed_piece.h"
#include "postproc/machine/planner/feed_plan.h"

namespace batten::postproc {

enum class FeedPlanner : std::uint8_t {
  kControl,  // none: the model of the machine's control
  kJerk,     // least time within the limits of each axis (postproc/machine/planner/feed_plan.h)
  kSCurve,   // Naseath 2007, section 4.5 (postproc/machine/planner/s_curve.h)
};

[[nodiscard]] constexpr std::string_view name_of(FeedPlanner planner) {
  constexpr std::string_view kNames[] = {"control", "jerk", "s-curve"};
  return kNames[static_cast<std::size_t>(planner)];
}

struct PlannedPiece {
  double seconds = 0;
  double slow_seconds = 0;  // of these, those below half of its feed
};

// Where the tool is: a parameter of a piece of the chain.
struct PlannedPosition {
  std::size_t piece = 0;
  double t = 0;
};

// A chain from rest to rest in time; `pieces` have a length and a feed each (with_length_and_feed).
// Blending and what else a control does with corners is left out: where the direction jumps by more
// than the machine can do within a period, the plan stops. So it does at the end of each piece
// where exact stop holds (stops_at_block_ends).
//
// By S-curves the machine has the least velocity, acceleration and jerk of its axes, along the path
// and across it; without a limit on jerk the speed changes at once with all of the acceleration.
class PlannedMotion {
 public:
  // Keeps a reference to `pieces`. `density`: of a plan by kJerk. Throws std::invalid_argument for
  // kControl.
  // tests/bench/feed_plan_cost prints how many pieces a second kJerk plans.
  PlannedMotion(std::span<const TimedPiece> pieces, const Machine& machine, FeedPlanner planner,
                const gcode::PathControl& path = {}, double density = kPlanDensity);

  [[nodiscard]] double duration() const { return duration_; }  // s

  // At a time from 0 to the duration; of a chain that is not empty.
  [[nodiscard]] PlannedPosition position_at(double time) const;

  [[nodiscard]] std::vector<PlannedPiece> times_of_pieces() const;

  // By kJerk: nodes whose pieces and distances are those of the chain. None by S-curves.
  [[nodiscard]] const std::vector<FeedPlanNode>& nodes() const { return nodes_; }

 private:
  std::span<const TimedPiece> pieces_;
  double duration_ = 0;
  std::vector<FeedPlanNode> nodes_;  // by kJerk
  // By kSCurve, and the way up to the end of each piece (mm).
  std::optional<JerkMotion> s_curves_;
  std::vector<double> ends_;
};

// Of each piece of the chain, as PlannedMotion has them.
[[nodiscard]] std::vector<PlannedPiece> planned_chain(std::span<const TimedPiece> pieces,
                                                      const Machine& machine, FeedPlanner planner,
                                                      const gcode::PathControl& path = {},
                                                      double density = kPlanDensity);

}  // namespace batten::postproc
