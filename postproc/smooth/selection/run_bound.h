// Whether rewriting a run can gain anything, told before the work is done. What is said to be
// hopeless would have been kept after all, as `choose` decides; what is not may still be kept.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/path/curve_pieces.h"
#include "postproc/machine/machine.h"
#include "postproc/options/options.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

// Seconds below which no form of the run comes that stays within `tolerance`: its length at its
// feeds, less what can be saved at its vertices, when there were no accelerations to mind.
[[nodiscard]] double least_time(const Run& run, double tolerance, const Machine& machine,
                                geometry::ToleranceKind kind = geometry::ToleranceKind::kPath);

// The part of the run's vertices whose chords would leave a curve through them by more than
// `tolerance`: a run of a coarser tolerance, of which only the corners could be rounded.
[[nodiscard]] double coarse_part(const Run& run, double tolerance);

// The least number of arcs and lines that the fair curve takes, by its straight parts: each is a
// line, and what joins two of them gently takes two arcs or more.
[[nodiscard]] double arcs_for(const geometry::MarkedPieces& curve);

// The methods beside `fair` that may win on a run, for Method::kBest. `corners` is coarse_part of
// it, `points` how many it has, `time` (s) what its fastest form so far takes on the machine.
// docs/algorithms/methods.md says why these.
[[nodiscard]] std::vector<Method> methods_worth_trying(double corners, std::size_t points,
                                                       double least_time, double time);

}  // namespace batten::postproc
