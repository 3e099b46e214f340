// The times of runs that go on into moves beside them: at cuts of a long run, and where moves that
// stay as they are come right before or after a run.
#pragma once

#include <cstdint>
#include <vector>

#include "postproc/options/options.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/run_smoother.h"

namespace batten::postproc {

// Blocks at which a part of a program is cut, increasing.
struct BoundaryCuts {
  const std::vector<std::uint32_t>& of_long_runs;
  const std::vector<std::uint32_t>& at_copied;  // where a section that is copied begins or ends
};

// Sets what is around each run of `works` (RunContext: lead, tail, of_neighbours).
void time_at_boundaries(const ProgramPart& part, const SmoothOptions& options,
                        const BoundaryCuts& cuts, const std::vector<Section>& sections,
                        std::vector<RunState>& works);

}  // namespace batten::postproc
