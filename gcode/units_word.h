// G20, G21 and what other controls say in their place.
#pragma once

#include <optional>

#include "gcode/block_words.h"
#include "gcode/modal_state.h"

namespace batten::gcode {

// The units that the block sets; nothing where it sets none. G70 and G71 with parameters are cycles
// of a lathe.
[[nodiscard]] std::optional<Units> units_set_by(const BlockWords& words);

// Whether G70 or G71 beside these words is such a cycle.
[[nodiscard]] bool is_lathe_cycle(Code code, const BlockWords& words);

}  // namespace batten::gcode
