// Units: G20, G21 and what other controls say in their place, and the sizes of printed numbers.
#pragma once

#include <optional>

#include "gcode/state/block_words.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {

// The units that the block sets; nothing where it sets none. G70 and G71 with parameters are cycles
// of a lathe.
[[nodiscard]] std::optional<Units> units_set_by(const BlockWords& words);

// Whether G70 or G71 beside these words is such a cycle.
[[nodiscard]] bool is_lathe_cycle(Code code, const BlockWords& words);

// 1 or 25.4. Throws std::invalid_argument for unknown units.
[[nodiscard]] double millimetres_per(Units units);

// The step between neighbouring numbers of a format, in mm.
[[nodiscard]] double printed_step(const NumberFormat& format, Units units);

}  // namespace batten::gcode
