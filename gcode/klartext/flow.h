// Where control can come from elsewhere in a Klartext program: labels that are called or jumped to,
// and the blocks behind them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/block_flow.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// One entry per block. A label that nothing names changes nothing. From one that is named on,
// blocks are a body up to LBL 0, or up to the last statement that names it, whichever comes later.
// A label that is named by a parameter may be any.
[[nodiscard]] std::vector<BlockFlow> find_klartext_flow(const Program& program);

// "CALL PGM NAME" of the content of a statement of KlartextKind::kCallProgram, in upper case and
// without quotes and .H: with its path where one stands there. Empty: no name is given.
[[nodiscard]] std::string klartext_call(std::string_view content);

}  // namespace batten::gcode
