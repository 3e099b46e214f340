// Where control can come from elsewhere: jump targets, loop bodies, subprograms. Only as much
// as is needed to leave such blocks alone.
#pragma once

#include <string>
#include <string_view>

#include "gcode/state/block_flow.h"
#include "gcode/state/own_words.h"
#include "gcode/state/subprograms.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// `text` is a line of ParseStatus::kFlow.
[[nodiscard]] FlowEffect flow_effect(std::string_view text);

// "O<NAME> CALL", "O100 CALL" of such a line that is a call alone; empty for others.
[[nodiscard]] std::string o_word_call(std::string_view text);

// A jump to a computed label makes every block with an N number a target. `own`, `called`: calls
// that the user or their files say something of; nullptr: none. `names_blocks`: ReadOptions.
[[nodiscard]] ProgramFlow follow_flow(const Program& program, Returns returns,
                                      const OwnWords* own = nullptr,
                                      const Subprograms* called = nullptr,
                                      bool names_blocks = false);

}  // namespace batten::gcode
