#include "gcode/state/block_words.h"

#include <algorithm>

namespace batten::gcode {
BlockWords::BlockWords(std::span<const Word> words) {
  for (const Word& word : words) {
    has_words_ |= word.letter != 'N';
    all_numbers_ &= word.is_number;
    if (word.letter == 'G' || word.letter == 'M') {
      add_code(word);
      continue;
    }
    if (word.letter < 'A' || word.letter > 'Z') continue;  // a corner word: its block says so
    const Word*& first = words_[slot(word.letter)];
    if (first != nullptr) note(Problem::kLetterTwice, first, &word);
    if (first == nullptr) first = &word;
  }
}

void BlockWords::add_code(const Word& word) {
  const bool is_g = word.letter == 'G';
  auto& [codes, code_words, count] = is_g ? g_ : m_;
  const Code code = code_of(word);
  if (code == kNoCode || count == kMaxCodes || (!is_g && code % 10 != 0)) {
    note(Problem::kBadCode, &word, nullptr);
    return;
  }
  const auto row_of = is_g ? row_of_g : row_of_m;
  for (std::size_t i = 0; i < count; ++i) {
    // Most controls refuse the same G word twice, of any group.
    if ((is_g && codes[i] == code) || exclude_each_other(row_of(codes[i]), row_of(code))) {
      note(Problem::kSameGroupTwice, code_words[i], &word);
    }
  }
  codes[count] = code;
  code_words[count++] = &word;
}

void BlockWords::note(Problem problem, const Word* first, const Word* second) {
  if (problem_ != Problem::kNone) return;
  problem_ = problem;
  first_ = first;
  second_ = second;
}

bool BlockWords::has_g(Code code) const {
  return std::ranges::find(g_codes(), code) != g_codes().end();
}

bool BlockWords::has_m(Code code) const {
  return std::ranges::find(m_codes(), code) != m_codes().end();
}

bool BlockWords::has_group(CodeGroup group) const {
  return std::ranges::any_of(g_codes(),
                             [group](Code code) { return row_of_g(code).group == group; });
}

bool BlockWords::has_trait(trait::Traits any) const {
  return std::ranges::any_of(g_codes(), [any](Code code) { return row_of_g(code).is(any); });
}

bool BlockWords::has_any(std::string_view letters) const {
  return std::ranges::any_of(letters, [this](char letter) { return has(letter); });
}

}  // namespace batten::gcode
