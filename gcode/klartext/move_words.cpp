#include "gcode/klartext/move_words.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

// No control takes such numbers.
constexpr double kTooGreat = 1e9;

constexpr int kGreatestDecimals = 255;

constexpr std::string_view kKlartextAxes = "XYZABCUVW";

bool is_axis(char letter) { return kKlartextAxes.find(letter) != std::string_view::npos; }

bool is_parameter(std::string_view letters) {
  return letters == "Q" || letters == "QL" || letters == "QR" || letters == "QS";
}

class MoveWordReader {
 public:
  MoveWordReader(std::string_view text, SourceSpan content)
      : text_(text), at_(content.begin), end_(content.end) {}

  [[nodiscard]] bool at_end() {
    while (at_ < end_ && is_blank(text_[at_])) ++at_;
    return at_ == end_;
  }

  // Capital letters from here on.
  std::string letters() {
    std::string read;
    while (at_ < end_ && is_letter(text_[at_])) read.push_back(upper(text_[at_++]));
    return read;
  }

  [[nodiscard]] std::uint32_t place() const { return at_; }
  [[nodiscard]] char peek() const { return at_ < end_ ? text_[at_] : '\0'; }
  void skip() { ++at_; }

  // Whether the value of a word begins behind the blanks here; goes there.
  bool finds_value() {
    std::uint32_t next = at_;
    while (next < end_ && is_blank(text_[next])) ++next;
    const char c = next < end_ ? text_[next] : '\0';
    const bool value = is_digit(c) || c == '+' || c == '-' || c == '.' || c == ',';
    if (value) at_ = next;
    return value;
  }

  // +1,5 -2. Q5 -QL3; `word` begins before the value. False for anything else.
  bool read_value(Word& word) {
    if (!finds_value()) return read_parameter(word);
    std::string digits;
    while (at_ < end_ && (is_digit(peek()) || peek() == '.' || peek() == ',' ||
                          (digits.empty() && (peek() == '+' || peek() == '-')))) {
      digits.push_back(peek() == ',' ? '.' : peek());
      ++at_;
    }
    if (digits.size() == 1 && !is_digit(digits[0])) return read_parameter(word);
    const auto number = read_number(digits);
    if (!number || std::abs(number->value) >= kTooGreat) return false;
    word.value = number->value;
    word.decimals = static_cast<std::uint8_t>(std::min(number->decimals, kGreatestDecimals));
    word.has_point = number->has_point;
    word.span.end = at_;
    return true;
  }

  // The digits of a parameter whose letters were read.
  bool read_parameter_number(Word& word) {
    const std::uint32_t begin = at_;
    while (is_digit(peek())) ++at_;
    word.is_number = false;
    word.span.end = at_;
    return at_ > begin;
  }

 private:
  bool read_parameter(Word& word) {
    while (is_blank(peek())) ++at_;
    return is_parameter(letters()) && read_parameter_number(word);
  }

  std::string_view text_;
  std::uint32_t at_;
  std::uint32_t end_;
};

class MoveReading {
 public:
  MoveReading(KlartextKind kind, std::string_view text, SourceSpan content,
              std::vector<Word>& words)
      : kind_(kind), reader_(text, content), words_(words) {}

  bool read() {
    const std::uint32_t begin = reader_.place();
    if (kind_ != KlartextKind::kFunctions) {
      (void)reader_.letters();
      motion_ = add('G', 1, {begin, reader_.place()});
    }
    while (!reader_.at_end()) {
      if (!read_word()) return false;
    }
    if (rapid_ && has_word('F')) return false;  // the control takes one of them
    return !is_arc_kind() || (sense_ != 0 && arc_has_its_words());
  }

 private:
  bool read_word() {
    const std::uint32_t begin = reader_.place();
    const std::string name = reader_.letters();
    if (name.empty()) return false;
    if (name == "M") return read_function(begin);
    if (kind_ == KlartextKind::kFunctions) return false;
    if (name == "FMAX") return be_rapid(begin);
    if (name == "FAUTO") return add_parameter_feed(begin);
    if (name == "RL" || name == "RR") {
      (void)add('G', name == "RL" ? 41 : 42, {begin, reader_.place()});
      return true;
    }
    if (name == "DR") return read_sense();
    if (name == "R") return read_r(begin);
    if (name == "F") return read_feed(begin);
    const char letter = name[0];
    if (!is_axis(letter) && letter != 'F') return false;
    Word word = word_from(letter, begin);
    if (name.size() > 1) {
      if (!is_parameter(std::string_view(name).substr(1)) || !reader_.read_parameter_number(word)) {
        return false;
      }
    } else if (!reader_.read_value(word)) {
      return false;
    }
    words_.push_back(word);
    return true;
  }

  bool read_function(std::uint32_t begin) {
    if (!reader_.finds_value()) return reader_.at_end() || is_letter(reader_.peek());
    Word word = word_from('M', begin);
    if (!is_digit(reader_.peek()) || !reader_.read_value(word)) return false;
    words_.push_back(word);
    return is_plain_function(word.value);
  }

  bool read_feed(std::uint32_t begin) {
    Word word = word_from('F', begin);
    if (reader_.finds_value()) {
      if (!reader_.read_value(word)) return false;
      words_.push_back(word);
      return true;
    }
    if (reader_.at_end()) return true;
    MoveWordReader ahead = reader_;
    const std::string next = ahead.letters();
    const bool own = next == "MAX" || next == "AUTO" || is_parameter(next);
    if (!own) return true;  // a bare F
    reader_ = ahead;
    if (next == "MAX") return be_rapid(begin);
    if (next == "AUTO") return add_parameter_feed(begin);
    if (!reader_.read_parameter_number(word)) return false;
    words_.push_back(word);
    return true;
  }

  // The word that says it is part of the text that is compared.
  bool be_rapid(std::uint32_t begin) {
    if (kind_ != KlartextKind::kLine || std::exchange(rapid_, true)) return false;
    Word& word = words_[motion_];
    word.value = 0;
    word.span = {begin, reader_.place()};
    return true;
  }

  bool add_parameter_feed(std::uint32_t begin) {
    Word word = word_from('F', begin);
    word.is_number = false;
    word.span.end = reader_.place();
    words_.push_back(word);
    return true;
  }

  bool read_sense() {
    const char sign = reader_.peek();
    if (!is_arc_kind() || sense_ != 0 || (sign != '+' && sign != '-')) return false;
    reader_.skip();
    sense_ = sign == '+' ? 1 : -1;
    words_[motion_].value = sense_ > 0 ? 3 : 2;
    words_[motion_].span.begin = reader_.place() - 3;  // DR+
    words_[motion_].span.end = reader_.place();
    return true;
  }

  // R0, or the radius of CR.
  bool read_r(std::uint32_t begin) {
    const bool signed_value = reader_.peek() == '+' || reader_.peek() == '-';
    if (kind_ == KlartextKind::kRadiusArc && (signed_value || reader_.peek() != '0')) {
      Word word = word_from('R', begin);
      if (!reader_.read_value(word)) return false;
      words_.push_back(word);
      return true;
    }
    if (reader_.at_end() || is_letter(reader_.peek())) return true;  // a bare R
    if (reader_.peek() != '0' || begin + 1 != reader_.place()) return false;
    Word zero;
    if (!reader_.read_value(zero) || zero.value != 0) return false;
    (void)add('G', 40, {begin, reader_.place()});
    return true;
  }

  [[nodiscard]] bool is_arc_kind() const {
    return kind_ == KlartextKind::kArc || kind_ == KlartextKind::kRadiusArc;
  }

  [[nodiscard]] bool has_word(char letter) const {
    return std::any_of(words_.begin() + static_cast<std::ptrdiff_t>(motion_), words_.end(),
                       [letter](const Word& word) { return word.letter == letter; });
  }

  [[nodiscard]] bool arc_has_its_words() const {
    const bool radius = kind_ == KlartextKind::kRadiusArc;
    return (has_word('X') || has_word('Y')) && !has_word('Z') && radius == has_word('R');
  }

  static Word word_from(char letter, std::uint32_t begin) {
    Word word;
    word.letter = letter;
    word.span.begin = begin;
    return word;
  }

  std::size_t add(char letter, double value, SourceSpan span) {
    Word word = word_from(letter, span.begin);
    word.value = value;
    word.span = span;
    words_.push_back(word);
    return words_.size() - 1;
  }

  KlartextKind kind_;
  MoveWordReader reader_;
  std::vector<Word>& words_;
  std::size_t motion_ = 0;  // index of its word
  bool rapid_ = false;
  int sense_ = 0;
};

}  // namespace

bool read_klartext_move(KlartextKind kind, std::string_view text, SourceSpan content,
                        std::vector<Word>& words) {
  return MoveReading(kind, text, content, words).read();
}

bool read_klartext_centre(std::string_view text, SourceSpan content, std::vector<Word>& words) {
  MoveWordReader reader(text, content);
  (void)reader.letters();  // CC
  while (!reader.at_end()) {
    Word word;
    word.span.begin = reader.place();
    const std::string name = reader.letters();
    if (name != "X" && name != "Y") return false;
    word.letter = name == "X" ? 'I' : 'J';
    if (!reader.read_value(word) || !word.is_number) return false;
    words.push_back(word);
  }
  return words.size() == 2 && words[0].letter != words[1].letter;
}

bool is_plain_function(double code) {
  const bool mirrors_elsewhere = code >= 21 && code <= 23;
  constexpr double kFirstSpecial = 89;
  constexpr double kRestoresElsewhere = 72;
  return code < kFirstSpecial && !mirrors_elsewhere && code != kRestoresElsewhere;
}

}  // namespace batten::gcode
