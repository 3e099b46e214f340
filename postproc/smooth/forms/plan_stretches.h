// The parts of a smoothed run between changes of feed, and where its comments go.
#pragma once

#include <span>
#include <vector>

#include "geometry/fitting/fair/fair.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/forms/output_plan.h"

namespace batten::postproc {

// A part of the curve that is run at one feed.
struct FeedStretch {
  double from = 0;  // parameters of the curve
  double to = 0;
  double feed = 0;  // mm/min
};

// In order, each starting where the one before it ends, from the curve's first parameter to its
// last. None is empty; neighbours have different feeds.
//
// Throws std::invalid_argument when `fair` does not have one parameter per point of the run, or
// when the run has no feed.
[[nodiscard]] std::vector<FeedStretch> feed_stretches(const Run& run,
                                                      const geometry::SmoothCurve& fair);

// Puts the run's comments into the plan. `starts`: the curve's parameter at the start of each
// move, not decreasing.
void place_comments(const Run& run, const geometry::SmoothCurve& fair,
                    std::span<const double> starts, OutputPlan& plan);

}  // namespace batten::postproc
