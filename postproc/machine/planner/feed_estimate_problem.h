// What the quick estimate's search solves: one stretch as sums over its ordinates, with its limits.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "geometry/path/path.h"
#include "postproc/machine/planner/feed_estimate_grid.h"
#include "postproc/machine/planner/feed_plan_limits.h"
#include "postproc/machine/planner/feed_plan_rows.h"

namespace batten::postproc {

// One interval.
struct EstimateCell {
  double length = 0;
  // q, p and r in the middle as sums over three neighbouring ordinates.
  LimitWindow q_of{};
  LimitWindow p_of{};
  LimitWindow r_of{};
  std::size_t first_row = 0;
  std::size_t jerk_rows = 0;  // these first
  std::size_t rows = 0;
  double most = KinematicPathLimits::kNone;  // of q in the middle
};

// A node between two intervals: q = before * u[k] + after * u[k + 1].
struct EstimateKnot {
  double before = 0;
  double after = 1;
  double weight = 0;                         // mm, of 1 / sqrt(q) in the time
  double most = KinematicPathLimits::kNone;  // of q
};

// What holds at an end of the stretch.
struct EstimateTie {
  bool ties = false;  // ordinate 1 = factor * ordinate 0 + offset
  bool pins = false;  // ordinates 0 and 1 are these
  double factor = 0;
  double offset = 0;
  double value = 0;
  double next = 0;
  double arc_length = 0;
  double arc_speed = 0;
};

struct EstimateProblem {
  std::vector<EstimateCell> cells;
  std::vector<EstimateKnot> knots;  // one more than cells
  std::vector<LimitWindow> rows;    // over q, p and r in the middle of their cell
  EstimateTie start;
  EstimateTie end;
};

[[nodiscard]] EstimateProblem make_estimate_problem(std::span<const geometry::PathPiece> path,
                                                    const EstimateStretch& stretch,
                                                    const KinematicPathLimits& limits);

}  // namespace batten::postproc
