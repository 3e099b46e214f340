// What the words of a block do to the control, other than a motion along X, Y, Z. The parts that
// belong together are in files of their own (word_modes.cpp, word_frames.cpp).
#pragma once

#include <optional>
#include <string_view>

#include "gcode/state/block_words.h"
#include "gcode/state/control_state.h"
#include "gcode/state/reason.h"

namespace batten::gcode {

// The sum over all words of a block.
struct StateEffect {
  // The first word's reason why the block cannot stand in a run; empty: they change nothing.
  std::string_view barrier;
  bool understood = true;         // false: a word is not known; everything is unknown after it
  Code unknown_code = -1;         // that G word
  bool takes_axes = false;        // the axis words do not belong to a motion (G28, G92, G10 ..)
  bool takes_parameters = false;  // P, Q, L, R, I .. belong to some word
  bool unit_word = false;
  bool feed_changed = false;
  Code motion = -1;  // the word of the motion group, -1: none
};

// Applies the G words but those of motions, then F, S, T, H, D, then the M words. What a word
// may have changed in ways that are not known is unknown in `state` afterwards.
//
// Requires words.problem() == kNone. Words without number make what they set unknown.
[[nodiscard]] StateEffect apply_words(const BlockWords& words, ControlState& state);

// What only happens at the end of the block, after its motion: calls, program end, tool change.
void apply_late_words(const BlockWords& words, ControlState& state);

// One block's words at work on the control.
class WordApplier {
 public:
  WordApplier(const BlockWords& words, ControlState& state) : words_(words), state_(state) {}

  StateEffect apply();

 private:
  ModalState& modal() { return state_.modal; }

  void block(std::string_view why) {
    if (effect_.barrier.empty()) {
      effect_.barrier = why;
    }
  }

  // A word that acts, whatever the state was.
  void acts(std::string_view why) {
    block(why);
    effect_.takes_parameters = true;
  }

  // Sets one item. Only a word that repeats an earlier word changes nothing.
  template <typename Item>
  void set(CodeGroup group, Item& item, Item value, std::string_view why = reason::kStateChange) {
    if (item != value || !state_.is_set(group)) {
      block(why);
    }
    item = value;
    state_.mark_set(group);
  }

  // Switches a transformation of the coordinates. When it changes, the place of the tool has
  // other coordinates than before.
  void set_frame(CodeGroup group, TriState& item, TriState value, std::string_view why) {
    if (item != value || value == TriState::kOn) {
      forget_position(state_);
    }
    set(group, item, value, why);
    if (value == TriState::kOn) {
      acts(why);
    }
  }

  void apply_g(Code code);

  // word_modes.cpp: how motions are read
  void apply_motion_word(Code code);
  void apply_cycle_end();
  void apply_feed_mode(FeedMode mode);
  void apply_units(Code code);
  void apply_cutter(Code code);
  void apply_tool_length(Code code);
  void apply_cycle_return(Code code);
  [[nodiscard]] bool has_cycle() const;
  void apply_work_offset(Code code);
  void apply_path_mode(Code code);
  void apply_diameter(Code code);

  // word_frames.cpp: what moves the origin, bends the coordinates, or acts in its block only
  void apply_one_block_word(Code code);
  void apply_axis_user(Code code);
  void apply_g92();
  void apply_scaling(Code code);
  void apply_rotation(Code code);
  void apply_cylindrical();
  void apply_smoothing(Code code);
  void apply_high_speed_mode();
  void apply_modal_macro(Code code);

  // word_applier.cpp: the words with other letters than G
  void apply_feed();
  [[nodiscard]] std::optional<double> feed_of(const Word& f) const;
  void apply_spindle_speed();
  void apply_tool_words();
  void apply_m(Code code);

  const BlockWords& words_;
  ControlState& state_;
  StateEffect effect_;
};

}  // namespace batten::gcode
