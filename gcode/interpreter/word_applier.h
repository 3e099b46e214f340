// What the words of a block do to the control, other than a motion along X, Y, Z; and what a block
// that was not split into words may have done.
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "gcode/state/modal_state.h"
#include "gcode/state/own_words.h"
#include "gcode/state/reason.h"
#include "gcode/text/program.h"

namespace batten::gcode {

// The sum over all words of a block.
struct StateEffect {
  // The first word's reason why the block cannot stand in a run; empty: they change nothing.
  std::string_view barrier;
  bool understood = true;         // false: a word is not known; everything is unknown after it
  Code unknown_code = kNoCode;    // that G word
  bool takes_axes = false;        // the axis words do not belong to a motion (G28, G92, G10 ..)
  bool takes_parameters = false;  // P, Q, L, R, I .. belong to some word
  bool unit_word = false;
  bool feed_changed = false;
  const CodeRow* motion = nullptr;  // of the word that says how the block moves
};

// Applies the G words but those of motions, then F, S, T, H, D, then the M words. What a word
// may have changed in ways that are not known is unknown in `state` afterwards.
//
// Requires words.problem() == kNone. Words without number make what they set unknown.
[[nodiscard]] StateEffect apply_words(const BlockWords& words, ControlState& state);

// The state behind a block whose words exclude each other, or say a letter twice: a control refuses
// it, or takes some of them. What any of them sets is unknown where it was something else; the
// place is not known, nor is the feed beside units. Nothing where a word may do more than set one
// mode, or takes others with it.
[[nodiscard]] std::optional<ControlState> after_some_of(std::span<const Word> words,
                                                        const ControlState& before);

// What only happens at the end of the block, after its motion: calls, program end, tool change.
void apply_late_words(const BlockWords& words, ControlState& state);

// The same of a word that the user vouches for: what it does not keep, and what words beside it,
// which may be its arguments, would set.
void apply_late_own(const OwnWord& own, const BlockWords& words, ControlState& state);

// Why a block that was not split into words is kept.
[[nodiscard]] std::string_view opacity_reason(ParseStatus opacity);

// Forgets what a block with this text could have changed: nothing for program marks, jumps and
// plain variables, the position for parameters that are windows into the control, otherwise
// everything. Not for blocks that list all their words.
void apply_opaque(ParseStatus opacity, std::string_view text, ControlState& state);

}  // namespace batten::gcode
