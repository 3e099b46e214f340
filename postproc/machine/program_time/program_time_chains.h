// The steps of a program cut where its motion comes to rest, as a machine's control runs them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/program_time/program_time_steps.h"

namespace batten::postproc {

// Motions from rest to rest, or one wait.
struct RunChain {
  StepKind wait = StepKind::kRest;   // meaningful where there are no pieces
  double seconds = 0;                // of the wait
  std::vector<TimedPiece> pieces;    // each with a length and a feed
  std::vector<std::uint32_t> steps;  // the step of each piece; of a wait its own
  StretchChain stretches;            // with places
};

// Calls `use` for each chain in the order of the program. The memory it needs is that of the
// longest chain. Times of tool changes and of the spindle are the machine's.
void for_each_chain(const gcode::Program& program, const ProgramSteps& steps,
                    const Machine& machine, const std::function<void(const RunChain&)>& use);

}  // namespace batten::postproc
