// Whether rewriting a run can gain anything, told before the work is done. What is said to be
// hopeless would have been kept after all, as `choose` decides; what is not may still be kept.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/curve_pieces.h"
#include "geometry/fair.h"
#include "postproc/machine/machine.h"
#include "postproc/options.h"
#include "postproc/runs/section.h"
#include "postproc/smoothing.h"

namespace batten::postproc {

// Seconds below which no form of the run comes that stays within `tolerance`: its length at its
// feeds, less what can be saved at its vertices, when there were no accelerations to mind.
[[nodiscard]] double least_time(const Run& run, double tolerance, const Machine& machine,
                                geometry::ToleranceKind kind = geometry::ToleranceKind::kPath);

// The part of the run's vertices whose chords would leave a curve through them by more than
// `tolerance`: a run of a coarser tolerance, of which only the corners could be rounded.
[[nodiscard]] double coarse_part(const Run& run, double tolerance);

// About how many chords a fair curve takes.
class ExpectedChords {
 public:
  explicit ExpectedChords(const geometry::FairPath& fair);

  // Within `deviation` (mm), where chords shorter than `min_length` (mm) may be twice as far off.
  [[nodiscard]] double within(double deviation, double min_length) const;

 private:
  struct Step {
    double length;  // mm
    double bend;    // the root of the curvature
  };
  std::vector<Step> steps_;  // a few for each span
};

// The least number of arcs and lines that the fair curve takes, by its straight parts: each is a
// line, and what joins two of them gently takes two arcs or more.
[[nodiscard]] double arcs_for(const geometry::MarkedPieces& curve);

// The methods beside `fair` that may win on a run, for Method::kBest. `corners` is coarse_part of
// it, `points` how many it has, `time` (s) what its fastest form so far takes on the machine.
// docs/algorithms/methods.md says why these.
[[nodiscard]] std::vector<Method> methods_worth_trying(double corners, std::size_t points,
                                                       double least_time, double time);

}  // namespace batten::postproc
