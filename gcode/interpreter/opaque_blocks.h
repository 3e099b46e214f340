// Blocks that were not split into words: why they are kept, and what they may have changed.
#pragma once

#include <string_view>

#include "gcode/state/control_state.h"
#include "gcode/text/program.h"

namespace batten::gcode {

[[nodiscard]] std::string_view opacity_reason(ParseStatus opacity);

// Forgets what a block with this text could have changed: nothing for program marks, jumps and
// plain variables, the place for parameters that are windows into the control, otherwise
// everything. Not for blocks that list all their words.
void apply_opaque(ParseStatus opacity, std::string_view text, ControlState& state);

}  // namespace batten::gcode
