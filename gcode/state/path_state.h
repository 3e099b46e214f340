// In which states of the control the words of a motion are its path.
#pragma once

#include "gcode/state/modal_state.h"

namespace batten::postproc {

// A state in which the path in X, Y, Z is all there is to a cutting motion. Unknown is not. What a
// control fits through the points by itself (COMPCAD) is its own deviation, in both programs.
[[nodiscard]] bool path_alone_counts(const gcode::ModalState& state);

}  // namespace batten::postproc
