// Which motions are the same on every control that can be told them.
#pragma once

#include <string_view>

#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "gcode/text/language.h"

namespace batten::postproc {

// Why the motion cannot be said in another language; empty where it can. `state`: behind its block.
[[nodiscard]] std::string_view why_no_certain_motion(const gcode::Motion& motion,
                                                     const gcode::ModalState& state,
                                                     gcode::Language language);

}  // namespace batten::postproc
