// What the words of a block say about its motion along X, Y, Z.
#pragma once

#include <string_view>

#include "gcode/interpreter/arc_from_words.h"
#include "gcode/interpreter/word_applier.h"
#include "gcode/state/block_words.h"
#include "gcode/state/control_state.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {

[[nodiscard]] MotionMode mode_of(Code motion);
[[nodiscard]] bool is_arc(MotionMode mode);

// Why a motion that is neither G0, G1, G2 nor G3 ends a run.
[[nodiscard]] std::string_view other_motion_reason(Code motion);

// Why the motion of a block cannot be followed in this state; empty when it can. `effect` is
// that of the block's other words.
[[nodiscard]] std::string_view why_not_followed(const BlockWords& words, const StateEffect& effect,
                                                const ControlState& state);

// Where the axis words lead, in mm. An increment from an unknown place leads to an unknown one.
// With unknown units the numbers stand for themselves: such motions are never rewritten.
[[nodiscard]] Position end_of_motion(const BlockWords& words, const ControlState& state);

// The arc of G2 or G3 from the state's place to `end`. Requires a known plane.
[[nodiscard]] ArcWords arc_words(const BlockWords& words, const ControlState& state,
                                 const Position& end);

}  // namespace batten::gcode
