// One run, smoothed: what could be written instead of it, and what each candidate costs.
#pragma once

#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

[[nodiscard]] SmoothedRun smooth_run(const Run& run, const RunContext& context,
                                     const SmoothOptions& options,
                                     CandidateScope scope = CandidateScope::kToChoose);

}  // namespace batten::postproc
