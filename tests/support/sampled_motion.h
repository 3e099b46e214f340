// A feed plan in time: what its nodes say about the motion between them.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_plan.h"
#include "postproc/machine/planner/planned_interval.h"

namespace batten::postproc {

// Seconds.
inline double planned_time(std::span<const geometry::PathPiece> path,
                           const KinematicPathLimits& limits, const PlanEnds& ends = {},
                           double density = kPlanDensity) {
  return plan_feed(path, limits, ends, density).time;
}

// A feed plan in time, as a control would send it to the axes.
struct MotionSample {
  double time = 0;                     // s
  std::size_t piece = 0;               // of the path
  double speed = 0;                    // mm/s along the path
  double tangential_acceleration = 0;  // mm/s^2
  double tangential_jerk = 0;          // mm/s^3
  geometry::Point3 position;
  geometry::Vector3 velocity;      // mm/s
  geometry::Vector3 acceleration;  // mm/s^2
  geometry::Vector3 jerk;          // mm/s^3
};

inline MotionSample sample_at(const geometry::PathPiece& piece, double t, const PlannedState& at,
                              double time) {
  const LengthDerivatives x = derivatives_by_length(piece, t);
  MotionSample sample;
  sample.time = time;
  sample.speed = std::sqrt(at.q);
  sample.tangential_acceleration = at.p / 2;
  sample.tangential_jerk = at.r / 2 * sample.speed;
  sample.position = geometry::point_at(piece, t);
  sample.velocity = x.first * sample.speed;
  sample.acceleration = x.second * at.q + x.first * (at.p / 2);
  sample.jerk = (x.third * at.q + x.second * (1.5 * at.p) + x.first * (0.5 * at.r)) * sample.speed;
  return sample;
}

// Calls `use` with the state every `period` seconds from 0 on, the end of the plan not included.
// `path` is the one that was planned.
template <typename Use>
void for_each_sample(std::span<const geometry::PathPiece> path, const FeedPlan& plan, double period,
                     const Use& use) {
  if (!(period > 0)) {
    throw std::invalid_argument("for_each_sample: period " + std::to_string(period) +
                                " s, expected above 0");
  }
  std::size_t k = 0;
  for (std::size_t i = 0; !plan.nodes.empty(); ++i) {
    const double time = static_cast<double>(i) * period;
    while (k + 1 < plan.nodes.size() && plan.nodes[k + 1].time <= time) ++k;
    if (k + 1 >= plan.nodes.size()) break;
    const FeedPlanNode& from = plan.nodes[k];
    const FeedPlanNode& to = plan.nodes[k + 1];
    const PlannedInterval interval(from, to);
    const double s = interval.distance_after(time - from.time);
    const double t1 = to.piece == from.piece ? to.t : 1;
    const double t = parameter_after(path[from.piece], from.t, t1, interval.length(), s);
    MotionSample sample = sample_at(path[from.piece], t, interval.at(s), time);
    sample.piece = from.piece;
    use(sample);
  }
}

inline std::vector<MotionSample> sample_motion(std::span<const geometry::PathPiece> path,
                                               const FeedPlan& plan, double period) {
  std::vector<MotionSample> samples;
  for_each_sample(path, plan, period, [&](const MotionSample& m) { samples.push_back(m); });
  return samples;
}

}  // namespace batten::postproc
