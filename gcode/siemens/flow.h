// Where the control can come from elsewhere in a Siemens program: labels that jumps and repetitions
// name, bodies of loops and branches, subprograms.
#pragma once

#include <string_view>
#include <vector>

#include "gcode/program.h"
#include "gcode/program_flow.h"

namespace batten::gcode {

// One per block. A label is NAME:, N100 or :100. Where a jump goes to something computed, or to a
// name that is no label, every label is a target. A program that ends with M17 or RET is called by
// others: all of it is a body.
[[nodiscard]] std::vector<BlockFlow> find_siemens_flow(const Program& program);

// What a line of Opacity::kFlow does to the state of the blocks after it.
[[nodiscard]] FlowEffect siemens_flow_effect(std::string_view text);

}  // namespace batten::gcode
