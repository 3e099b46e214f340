// A feed plan in time: the motion between two of its nodes.
#pragma once

#include <array>

#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/speed_cubic.h"

namespace batten::postproc {

// By the distance (mm) and time (s) from its start.
class PlannedInterval {
 public:
  // Neighbouring nodes, with a way between them.
  PlannedInterval(const FeedPlanNode& from, const FeedPlanNode& to);

  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] PlannedState at(double s) const;

  // The distance `time` seconds after the start.
  [[nodiscard]] double distance_after(double time) const;

 private:
  [[nodiscard]] PlannedState power(double q1, double slope, double s) const;
  [[nodiscard]] double growth(double p1, double q1) const;
  [[nodiscard]] double seconds(double s) const;

  double length_;
  double duration_;
  std::array<double, 4> window_;  // q and p at both ends
};

}  // namespace batten::postproc
