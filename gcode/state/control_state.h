// All that the interpreter knows about the control between two blocks.
#pragma once

#include <cstdint>
#include <string_view>

#include "gcode/state/block_words.h"
#include "gcode/state/code_table.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {

inline constexpr double kMillimetresPerInch = 25.4;

struct ControlState {
  ModalState modal;
  Position position;
  // With MotionMode::kOther: which kind of motion, as the reason to keep its blocks.
  std::string_view other_motion;
  Code work_offset = 0;  // G54 .. as programmed; 0: not known
  // Groups (bit = CodeGroup) that a word has set. A word that repeats what is only assumed of
  // the control at power-on is no repetition: it must stay.
  std::uint32_t set_by_word = 0;
  bool calls_keep_modes = false;  // ReadOptions

  [[nodiscard]] bool is_set(CodeGroup group) const { return (set_by_word & bit(group)) != 0; }
  void mark_set(CodeGroup group) { set_by_word |= bit(group); }

 private:
  static std::uint32_t bit(CodeGroup group) { return 1U << static_cast<unsigned>(group); }
};

void forget_axis(ControlState& state, std::size_t axis);
void forget_position(ControlState& state);

// State and place: the block could have changed anything.
void forget_everything(ControlState& state);

// What a subprogram or a macro could have changed.
void forget_what_calls_change(ControlState& state);

// The axes that the block names. U, V, W are increments of X, Y, Z on lathes.
void forget_named_axes(ControlState& state, const BlockWords& words);

// Does the control know the same in both?
[[nodiscard]] bool same_knowledge(const ControlState& a, const ControlState& b);

// What is known when either state may hold.
[[nodiscard]] ControlState either(const ControlState& a, const ControlState& b);

// Units that become known or unknown take the places with them: those were numbers without a
// meaning. Between inch and millimetre places stay (as LinuxCNC and grbl keep them), while the
// meaning of the last F differs from control to control: it is forgotten.
void set_units(ControlState& state, Units units);

}  // namespace batten::gcode
