// Where the control can come from elsewhere in a Siemens program: labels that jumps and repetitions
// name, bodies of loops and branches, subprograms.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/block_flow.h"
#include "gcode/state/own_words.h"
#include "gcode/state/subprograms.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// One per block. A label is NAME:, N100 or :100. Where a jump goes to something computed, or to a
// name that is no label, every label is a target; so is it with kToAnyLabel where anything is
// called that is not known to come back behind its call. A program that ends with M17 or RET is
// called by others. `own`, `called`: calls that the user or their files
// say something of; nullptr: none.
[[nodiscard]] std::vector<BlockFlow> find_siemens_flow(const Program& program, Returns returns,
                                                       const OwnWords* own,
                                                       const Subprograms* called);

// "L54", "CONTOUR": what a line calls that is a call alone, by itself (not MCALL), once or as often
// as P says, with arguments or without. In upper case; empty for other lines.
[[nodiscard]] std::string siemens_call(std::string_view line);

// L100, CALL "PART", PART(1,2), MCALL PART: does the line call a program, of its own or of others?
// Not where the name is one that is known.
[[nodiscard]] bool calls_siemens_program(std::string_view line);

// What a line of ParseStatus::kFlow does to the state of the blocks after it.
[[nodiscard]] FlowEffect siemens_flow_effect(std::string_view text);

}  // namespace batten::gcode
