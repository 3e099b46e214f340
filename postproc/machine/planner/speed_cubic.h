// speed^2 as a cubic of the distance: the motion on an interval between two nodes of a feed plan.
#pragma once

#include "geometry/basic/point.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

// q = (ds/dt)^2 and its first two derivatives by the distance s, mm.
struct PlannedState {
  double q = 0;
  double p = 0;
  double r = 0;

  // mm/s^2 and mm/s^3, where the path is `x`.
  [[nodiscard]] geometry::Vector3 acceleration(const LengthDerivatives& x) const;
  [[nodiscard]] geometry::Vector3 jerk(const LengthDerivatives& x) const;
};

// `s` mm after the start of an interval with q and p at both ends: w = {q0, p0, q1, p1}.
[[nodiscard]] PlannedState state_in(const double* w, double length, double s);

// Of the whole interval: Simpson's rule on 1 / speed.
[[nodiscard]] double interval_seconds(double length, const double* w);

}  // namespace batten::postproc
