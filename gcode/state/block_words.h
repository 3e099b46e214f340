// The words of one block, sorted: its codes, and the value of each other letter.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "gcode/state/code_table.h"
#include "gcode/text/program.h"

namespace batten::gcode {

class BlockWords {
 public:
  // Why the words cannot be taken together. `first` and `second` are the words at fault.
  enum class Problem : std::uint8_t {
    kNone,
    kSameGroupTwice,  // two words of one modal group
    kLetterTwice,     // X1 X2
    kBadCode,         // G1.25, M-3, G#1, or more codes than a block can hold
  };

  explicit BlockWords(std::span<const Word> words);

  [[nodiscard]] std::span<const Code> g_codes() const { return g_.all(); }
  [[nodiscard]] std::span<const Code> m_codes() const { return m_.all(); }
  [[nodiscard]] bool has_g(Code code) const;
  [[nodiscard]] bool has_m(Code code) const;
  // Has it a G word of this group, or with one of these traits?
  [[nodiscard]] bool has_group(CodeGroup group) const;
  [[nodiscard]] bool has_trait(trait::Traits any) const;

  // The word of a letter other than G and M, nullptr where there is none.
  [[nodiscard]] const Word* find(char letter) const { return words_[slot(letter)]; }
  [[nodiscard]] bool has(char letter) const { return find(letter) != nullptr; }
  [[nodiscard]] bool has_any(std::string_view letters) const;

  // Does any word but N stand here?
  [[nodiscard]] bool has_words() const { return has_words_; }
  // Has every word a number?
  [[nodiscard]] bool all_numbers() const { return all_numbers_; }

  [[nodiscard]] Problem problem() const { return problem_; }
  [[nodiscard]] const Word* first() const { return first_; }
  [[nodiscard]] const Word* second() const { return second_; }

 private:
  // RS-274 has 15 modal groups; with several words without a group a block stays below this.
  static constexpr std::size_t kMaxCodes = 16;

  // Filled up to its count only: clearing it would take longer than reading a block.
  struct Codes {
    std::array<Code, kMaxCodes> codes;
    std::array<const Word*, kMaxCodes> words;
    std::size_t count = 0;
    [[nodiscard]] std::span<const Code> all() const { return {codes.data(), count}; }
  };

  static std::size_t slot(char letter) { return static_cast<std::size_t>(letter - 'A'); }
  void add_code(const Word& word);
  void note(Problem problem, const Word* first, const Word* second);

  std::array<const Word*, 26> words_{};
  Codes g_;
  Codes m_;
  bool has_words_ = false;
  bool all_numbers_ = true;
  Problem problem_ = Problem::kNone;
  const Word* first_ = nullptr;
  const Word* second_ = nullptr;
};

}  // namespace batten::gcode
