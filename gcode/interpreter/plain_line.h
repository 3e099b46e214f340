// The way of nearly all blocks of a long program through the interpreter: places of X, Y and Z, one
// after the other in straight lines, with N, G0 or G1 and F beside them where a block has such.
#pragma once

#include <cstdint>

#include "gcode/interpreter/program_flow.h"
#include "gcode/state/control_state.h"
#include "gcode/state/motion.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// Does with such a block of the RS-274 family what the interpreter does with it: adds its meaning,
// its motion and what state is new to `read` and goes to its end. False, and nothing done, where
// the block or the state is of another kind. `now`: the last of `read.states`, and the place before
// the block.
[[nodiscard]] bool read_plain_line(const Program& program, std::uint32_t index,
                                   const BlockFlow& flow, ControlState& now, Interpretation& read);

}  // namespace batten::gcode
