#include "gcode/curves/siemens_words.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

class SiemensReader {
 public:
  explicit SiemensReader(std::string_view text) : text_(text) {}

  std::optional<std::vector<SiemensWord>> read() {
    std::vector<SiemensWord> words;
    while (skip_blanks() != '\0' && peek() != ';') {
      SiemensWord word;
      if (!read_word(word)) return std::nullopt;
      words.push_back(std::move(word));
    }
    return words;
  }

 private:
  char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }

  char skip_blanks() {
    while (is_blank(peek())) ++at_;
    return peek();
  }

  bool take(char wanted) {
    if (skip_blanks() != wanted) return false;
    ++at_;
    return true;
  }

  bool read_word(SiemensWord& word) {
    while (is_letter(peek()) || peek() == '_') word.name.push_back(upper(text_[at_++]));
    if (word.name.empty()) return false;
    if (skip_blanks() == '[' && !read_index(word)) return false;
    if (take('=')) return take('(') ? read_list(word) : read_number_into(word);
    if (word.name.size() > 1) return true;  // a keyword
    return read_number_into(word);
  }

  // [X] or [].
  bool read_index(SiemensWord& word) {
    ++at_;
    word.name.push_back('[');
    while (is_letter(skip_blanks())) word.name.push_back(upper(text_[at_++]));
    word.name.push_back(']');
    return take(']') && skip_blanks() == '=';
  }

  bool read_list(SiemensWord& word) {
    do {
      if (!read_number_into(word)) return false;
    } while (take(','));
    return take(')');
  }

  bool read_number_into(SiemensWord& word) {
    skip_blanks();
    // Blanks end a number here.
    std::size_t end = at_;
    while (end < text_.size() && (is_digit(text_[end]) || text_[end] == '.' ||
                                  (end == at_ && (text_[end] == '-' || text_[end] == '+')))) {
      ++end;
    }
    const auto number = read_number(text_.substr(at_, end - at_));
    if (!number || std::abs(number->value) >= kNumberLimit) return false;
    // 1EX3 and G1X5: the first is an exponent, the second are two words.
    if (end + 1 < text_.size() && upper(text_[end]) == 'E' && upper(text_[end + 1]) == 'X') {
      return false;
    }
    at_ = end;
    word.values.push_back(number->value);
    word.decimals = std::max(word.decimals, number->decimals);
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<std::vector<SiemensWord>> read_siemens_words(std::string_view block) {
  return SiemensReader(block).read();
}

}  // namespace batten::gcode
