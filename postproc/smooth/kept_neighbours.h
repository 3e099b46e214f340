// A run between moves that stay as they are: the machine goes on from them into it, and from it
// into them, so that its time is not that from rest to rest.
#pragma once

#include <vector>

#include "postproc/machine/models/cycle_time.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

// Sets lead, tail and what goes with them in the `context` of the run: its times are those from
// rest to rest, changed by what a form changes where it is. Of `lead` and `tail`, the moves right
// before and after it up to where the machine rests, only as much is kept as bears on these times;
// nothing is set where both are empty.
void put_between(std::vector<TimedPiece> lead, std::vector<TimedPiece> tail, const Run& run,
                 const Machine& machine, RunContext& context);

}  // namespace batten::postproc
