// Where control can come from elsewhere: jump targets, loop bodies, subprograms. Only as much
// as is needed to leave such blocks alone.
#pragma once

#include <string_view>

#include "gcode/state/block_flow.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// `text` is a line of ParseStatus::kFlow.
[[nodiscard]] FlowEffect flow_effect(std::string_view text);

// A jump to a computed label makes every block with an N number a target.
[[nodiscard]] ProgramFlow follow_flow(const Program& program, Returns returns);

}  // namespace batten::gcode
