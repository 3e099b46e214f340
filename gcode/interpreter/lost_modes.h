// Which block it was that left the modes unknown, and what that costs.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gcode/state/block_flow.h"
#include "gcode/state/diagnostic_limiter.h"
#include "gcode/state/motion.h"
#include "gcode/text/diagnostic.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// The block behind which the modes are not known, while they are not; carried from part to part.
struct LostModes {
  bool lost = false;
  SourceSpan where;       // the block
  std::string text;       // of the block, for people
  bool by_call = false;   // of a subprogram
  std::string missing;    // at the last of the moves: what was not set again, in words
  std::size_t moves = 0;  // blocks with X, Y or Z behind it, so far
};

// Follows the states of a part that was interpreted, and adds a warning modes-unknown for each
// block behind which moves are copied because modes that are asked for are unknown (is_known), once
// these are set again. Definitions of subprograms (`flow`) are no part of that. Linear.
void follow_lost_modes(const Program& part, const std::vector<BlockFlow>& flow,
                       const Interpretation& read, ModeSet asked, LostModes& modes,
                       DiagnosticLimiter& limiter, Diagnostics& found);

// The warning of modes that are not known to the end of the program.
void tell_lost_modes(const LostModes& modes, Diagnostics& found);

}  // namespace batten::gcode
