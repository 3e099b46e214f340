// Words whose effect their user vouches for: M501 of a builder, a macro of the shop (G65 P9810), a
// program that is called by name, and words of coordinates that some controls have for something
// else (G51 and G52 of Philips controls choose zero points).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/state/block_words.h"
#include "gcode/state/modal_state.h"

namespace batten::gcode {

// What is after the block of such a word as it was before; what is not kept is unknown. Whatever is
// kept, the block is copied and a run ends there.
struct OwnEffect {
  bool keeps_modes = false;   // units, plane, G90, compensation, offsets ..
  bool keeps_motion = false;  // kind of motion, feed, spindle speed
  bool keeps_place = false;   // the position
  bool returns = false;       // of a call: it goes on at the block behind it, at no label
  bool operator==(const OwnEffect&) const = default;
};

// A phrase that a user may say of a word.
struct OwnEffectRow {
  std::string_view name;
  std::string_view text;  // one line for the user
  OwnEffect effect;
  bool of_calls = false;  // only calls can do this
};

// All of them.
[[nodiscard]] std::span<const OwnEffectRow> own_effects();

struct OwnWord {
  std::string name;     // as in OwnWords::find: "M501", "G65 P9810", "O<PROBE> CALL"
  std::string effects;  // as the user says them
  OwnEffect effect;
};

// A word of scales and origins that on some controls chooses a zero point, or none: all that a user
// may say of it is that the position is unknown behind it.
[[nodiscard]] bool may_choose_zero(const CodeRow& row);

// Whether a user may say what a G word does: that, a call, or a word that Batten does not know.
[[nodiscard]] inline bool may_be_own_g(const CodeRow& row) {
  return row.group == CodeGroup::kUnknown || row.act == CodeAct::kCalls || may_choose_zero(row);
}

// "G65 P9810" of a block whose one call is of a program by its number, from its beginning (no M98
// H); empty for others.
[[nodiscard]] std::string numbered_call(const BlockWords& words);

class OwnWords {
 public:
  OwnWords() = default;
  explicit OwnWords(std::vector<OwnWord> words) : words_(std::move(words)) {}

  [[nodiscard]] std::span<const OwnWord> all() const { return words_; }
  // nullptr: nothing is said of it. Names: M501, G100.1; of calls M98 P9001, M198 P9001, G65 P9810,
  // O<NAME> CALL, O100 CALL, L54, NAME, CALL PGM NAME; #MSG of a control's own.
  [[nodiscard]] const OwnWord* find(std::string_view name) const;
  // Of a word of this block: of its call where the code is one.
  [[nodiscard]] const OwnWord* find(char letter, Code code, const BlockWords& words) const;

 private:
  std::vector<OwnWord> words_;
};

// ReadOptions::own_words as the state has them; nullptr where nothing is said of the word.
[[nodiscard]] inline const OwnWord* own_word(const ControlState& state, char letter, Code code,
                                             const BlockWords& words) {
  return state.own_words == nullptr ? nullptr : state.own_words->find(letter, code, words);
}
[[nodiscard]] inline const OwnWord* own_call(const ControlState& state, std::string_view name) {
  return state.own_words == nullptr || name.empty() ? nullptr : state.own_words->find(name);
}

// Forgets what the word does not keep.
void apply_own(const OwnEffect& effect, ControlState& state);

}  // namespace batten::gcode
