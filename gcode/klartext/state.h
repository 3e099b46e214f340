// What Klartext statements that are copied may have changed. What is not known to leave an item
// alone makes it unknown. Facts: docs/controllers/heidenhain.md.
#pragma once

#include <cstdint>
#include <string_view>

#include "gcode/state/modal_state.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// The state in which Klartext programs begin: arc centres are absolute places. Units are named by
// BEGIN PGM and never change.
void start_klartext(ControlState& state);

// The text of the statement that begins in block `first`, with the lines that continue it.
[[nodiscard]] std::string_view klartext_statement_text(const Program& program, std::uint32_t first);

// Applies a statement that was not split into words. Returns why it is kept (reason.h).
[[nodiscard]] std::string_view apply_klartext(std::string_view statement, ControlState& state);

// As forget_everything, but for what no Klartext statement changes: units, absolute distances.
void forget_klartext(ControlState& state);

}  // namespace batten::gcode
