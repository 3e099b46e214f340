#include "gcode/state/block_words.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "gcode/state/code_groups.h"

namespace batten::gcode {
namespace {

// Nothing when the word is no code of at most one decimal. 9999 is above every code of every
// control and keeps the conversion to an integer safe.
std::optional<Code> code_of(const Word& word) {
  constexpr double kMaxCode = 9999;
  if (!word.is_number || !(word.value >= 0) || word.value > kMaxCode) {
    return std::nullopt;
  }
  const double tenths = word.value * 10;
  const double whole = std::round(tenths);
  // Far above the rounding of a product of two numbers below 1e5, far below one tenth.
  constexpr double kSameCode = 1e-6;
  if (std::abs(tenths - whole) > kSameCode) {
    return std::nullopt;
  }
  return static_cast<Code>(whole);
}

// Words of one group exclude each other. The same word twice is refused by most controls too.
bool exclude_each_other(Code a, Code b) {
  if (a == b) {
    return true;
  }
  const CodeGroup group = group_of_g(a);
  return group != CodeGroup::kNone && group != CodeGroup::kUnknown && group == group_of_g(b);
}

}  // namespace

BlockWords::BlockWords(std::span<const Word> words) {
  for (const Word& word : words) {
    has_words_ |= word.letter != 'N';
    all_numbers_ &= word.is_number;
    if (word.letter == 'G' || word.letter == 'M') {
      add_code(word);
      continue;
    }
    if (word.letter < 'A' || word.letter > 'Z') {
      continue;  // a corner word: its block says so
    }
    const Word*& place = words_[slot(word.letter)];
    if (place != nullptr) {
      note(Problem::kLetterTwice, place, &word);
    } else {
      place = &word;
    }
  }
}

void BlockWords::add_code(const Word& word) {
  const bool is_g = word.letter == 'G';
  auto& codes = is_g ? g_ : m_;
  auto& code_words = is_g ? g_words_ : m_words_;
  std::size_t& count = is_g ? g_count_ : m_count_;
  const std::optional<Code> code = code_of(word);
  if (!code || count == kMaxCodes || (!is_g && *code % 10 != 0)) {
    note(Problem::kBadCode, &word, nullptr);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (is_g ? exclude_each_other(codes[i], *code) : excludes_m(codes[i], *code)) {
      note(Problem::kSameGroupTwice, code_words[i], &word);
    }
  }
  codes[count] = *code;
  code_words[count] = &word;
  ++count;
}

void BlockWords::note(Problem problem, const Word* first, const Word* second) {
  if (problem_ == Problem::kNone) {
    problem_ = problem;
    first_ = first;
    second_ = second;
  }
}

bool BlockWords::has_g(Code code) const {
  return std::ranges::find(g_codes(), code) != g_codes().end();
}

bool BlockWords::has_m(Code code) const {
  return std::ranges::find(m_codes(), code) != m_codes().end();
}

bool BlockWords::has_any(std::string_view letters) const {
  return std::ranges::any_of(letters, [this](char letter) { return has(letter); });
}

}  // namespace batten::gcode
