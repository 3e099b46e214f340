// The way of nearly all blocks of a long program through the interpreter: places of X, Y and Z
// alone, one after the other in straight lines.
#pragma once

#include <cstdint>

#include "gcode/control_state.h"
#include "gcode/motion.h"
#include "gcode/program.h"
#include "gcode/program_flow.h"

namespace batten::gcode {

// Does with such a block what the interpreter does with it: adds its meaning and its motion to
// `read` and goes to its end. False, and nothing done, where the block or the state is of another
// kind. `now`: the last of `read.states`, and the place before the block.
[[nodiscard]] bool read_plain_line(const Program& program, std::uint32_t index,
                                   const BlockFlow& flow, ControlState& now, Interpretation& read);

}  // namespace batten::gcode
