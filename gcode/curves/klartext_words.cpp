#include "gcode/curves/klartext_words.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <utility>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

class KlartextReader {
 public:
  explicit KlartextReader(std::string_view text) : text_(text) {}

  std::optional<KlartextLine> read() {
    KlartextLine line;
    if (is_digit(skip_blanks())) {
      line.number = digits();
      if (!line.number) return std::nullopt;
    }
    while (skip_blanks() != '\0' && peek() != ';') {
      if (peek() == '~') {
        ++at_;
        line.continues = true;
        if (skip_blanks() != '\0') return std::nullopt;
        break;
      }
      KlartextWord word;
      if (!read_word(word)) return std::nullopt;
      line.words.push_back(std::move(word));
    }
    return line;
  }

 private:
  char peek(std::size_t ahead = 0) const {
    return at_ + ahead < text_.size() ? text_[at_ + ahead] : '\0';
  }

  char skip_blanks() {
    while (is_blank(peek())) ++at_;
    return peek();
  }

  std::optional<int> digits() {
    int value = 0;
    const char* begin = text_.data() + at_;
    const auto read = std::from_chars(begin, text_.data() + text_.size(), value);
    if (read.ec != std::errc{}) return std::nullopt;
    at_ += static_cast<std::size_t>(read.ptr - begin);
    return value;
  }

  bool is_spline_word() const {
    return upper(peek()) == 'K' && peek(1) >= '1' && peek(1) <= '3' && is_letter(peek(2));
  }

  bool read_word(KlartextWord& word) {
    if (is_spline_word()) {
      word.name = {'K', peek(1), upper(peek(2))};
      at_ += 3;
      return read_value(word) && read_exponent(word);
    }
    while (is_letter(peek())) word.name.push_back(upper(text_[at_++]));
    if (word.name.empty()) return false;
    // The sense of an arc; with digits behind it, a difference of the tool's radius.
    if (word.is("DR") && (peek() == '+' || peek() == '-') && !is_digit(peek(1)) && peek(1) != '.') {
      word.name.push_back(text_[at_++]);
      return true;
    }
    const char next = peek();
    const bool has_value = is_digit(next) || next == '+' || next == '-' || next == '.';
    return !has_value || read_value(word);
  }

  bool read_value(KlartextWord& word) {
    std::string digits;
    while (is_digit(peek()) || peek() == '.' || peek() == ',' ||
           (digits.empty() && (peek() == '+' || peek() == '-'))) {
      digits.push_back(peek() == ',' ? '.' : peek());
      ++at_;
    }
    const auto number = read_number(digits);
    if (!number || std::abs(number->value) >= kNumberLimit) return false;
    word.mantissa = number->value;
    word.value = number->value;
    word.decimals = number->decimals;
    return true;
  }

  // E-002, also behind a blank.
  bool read_exponent(KlartextWord& word) {
    std::size_t ahead = 0;
    while (is_blank(peek(ahead))) ++ahead;
    if (upper(peek(ahead)) != 'E') return true;
    at_ += ahead + 1;
    const bool negative = peek() == '-';
    if (negative || peek() == '+') ++at_;
    const auto exponent = digits();
    if (!exponent || *exponent > 308) return false;
    word.exponent = negative ? -*exponent : *exponent;
    // Dividing by a power of ten that is exact rounds once.
    const double power = std::pow(10.0, *exponent);
    word.value = negative ? word.mantissa / power : word.mantissa * power;
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

}  // namespace

std::optional<KlartextLine> read_klartext_line(std::string_view line) {
  return KlartextReader(line).read();
}

}  // namespace batten::gcode
