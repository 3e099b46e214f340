// The trajectory generator of Naseath 2007, section 4.5, for comparison with his tables: cycle
// times that Batten decides with come from postproc/machine/models/cycle_time.h. It stops
// accelerating at every extremum of the curvature, which costs 4 to 32 % of the time
// (docs/algorithms/naseath.md).
#pragma once

#include <span>
#include <vector>

#include "geometry/path/parameter_samples.h"

namespace batten::postproc {

struct SCurveLimits {
  double velocity = 400;       // mm/s
  double acceleration = 4000;  // mm/s^2, along the path, and across it: curvature * v^2
  double jerk = 20000;         // mm/s^3, along the path; may be infinite
};

// Seconds for a change of the speed (mm/s, not negative) without acceleration at both ends.
[[nodiscard]] double s_curve_change(double change, const SCurveLimits& limits);

// A place that is passed at this speed without acceleration.
struct SCurveNode {
  double distance = 0;  // mm from the start
  double velocity = 0;  // mm/s
};

// Both ends and the local extrema of the allowed speed (of an even stretch the sample in the
// middle by number), lowered until an S-curve fits between each two neighbours. It starts and ends
// at the speed allowed there, not at rest. None without samples.
[[nodiscard]] std::vector<SCurveNode> s_curve_nodes(
    std::span<const geometry::ParameterSample> samples, const SCurveLimits& limits);

// Seconds. Between two nodes the S-curve is stretched over the whole distance.
[[nodiscard]] double s_curve_time(std::span<const geometry::ParameterSample> samples,
                                  const SCurveLimits& limits);

// mm/s: the mean of the speeds at the samples, each counted once: the "average feedrate" of table
// 4-2. A short span weighs as much as a long one. 0 without samples.
[[nodiscard]] double s_curve_sampled_feed(std::span<const geometry::ParameterSample> samples,
                                          const SCurveLimits& limits);

}  // namespace batten::postproc
