// The moves on both sides of the place where a long run is cut (postproc/runs/long_run_cuts.h).
#pragma once

#include <cstdint>
#include <vector>

#include "gcode/state/motion.h"
#include "gcode/text/program.h"
#include "postproc/machine/models/cycle_time.h"

namespace batten::postproc {

// The machine looks ahead over no more blocks to stop.
inline constexpr std::uint32_t kNeighbourBlocks = 100;

// What is cut in the last of the blocks before `block`, and in it and those behind it: no more than
// that many blocks, none beyond what ends a run, and none before `from` or from `end` on.
[[nodiscard]] std::vector<TimedPiece> moves_before(const gcode::Program& program,
                                                   const gcode::Interpretation& meaning,
                                                   std::uint32_t block, std::uint32_t from = 0);
[[nodiscard]] std::vector<TimedPiece> moves_from(const gcode::Program& program,
                                                 const gcode::Interpretation& meaning,
                                                 std::uint32_t block,
                                                 std::uint32_t end = UINT32_MAX);

}  // namespace batten::postproc
