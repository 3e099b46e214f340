// Which motions are the same on every control that can be told them.
#pragma once

#include <string_view>

#include "gcode/language.h"
#include "gcode/modal_state.h"
#include "gcode/motion.h"

namespace batten::postproc {

// Why the motion cannot be said in another language; empty where it can. `state`: behind its block.
[[nodiscard]] std::string_view why_no_certain_motion(const gcode::Motion& motion,
                                                     const gcode::ModalState& state,
                                                     gcode::Language language);

}  // namespace batten::postproc
