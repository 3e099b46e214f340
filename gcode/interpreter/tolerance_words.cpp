#include "gcode/interpreter/tolerance_words.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

#include "gcode/klartext/statement.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

using Kind = ToleranceWords::Kind;

// By itself it may be anything: TOL CHECK.
constexpr std::string_view kShortName = "TOL";
constexpr std::array<std::string_view, 3> kNames = {"TOLERANCE", "TOLERANZ", kShortName};
// NX says one for each side of the surface: together they are no length by which a path may move.
constexpr std::array<std::string_view, 2> kNamesOfOneSide = {"INTOL", "OUTTOL"};
constexpr std::array<std::string_view, 4> kBeforeName = {"CUT", "CUTTING", "MACHINING", "TOTAL"};

struct UnitName {
  std::string_view name;
  Units units;
};
constexpr std::array kUnitNames = {UnitName{"MM", Units::kMillimetre}, UnitName{"IN", Units::kInch},
                                   UnitName{"INCH", Units::kInch},
                                   UnitName{"INCHES", Units::kInch}};

template <std::size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& names) {
  return std::ranges::find(names, word) != names.end();
}

ToleranceWords stated(double value, Units units) { return {Kind::kStated, {value, units}}; }

// A number without a sign, above zero.
std::optional<double> length_in(std::string_view text) {
  if (text.empty() || !(is_digit(text.front()) || text.front() == '.')) return std::nullopt;
  if (std::ranges::any_of(text, is_blank)) return std::nullopt;  // 0. 01
  const auto number = read_number(text);
  if (!number || !(number->value > 0 && number->value < kNumberLimit)) return std::nullopt;
  return number->value;
}

// Goes through the words and signs of a comment, in capitals.
class CommentCursor {
 public:
  explicit CommentCursor(std::string_view text) : text_(text) { skip_blanks(); }

  [[nodiscard]] bool at_end() const { return at_ == text_.size(); }

  // The letters from here on.
  std::string_view word() { return take_while(is_letter); }
  std::string_view number() {
    return take_while([](char c) { return is_digit(c) || c == '.'; });
  }
  bool take(char c) {
    if (char_at(text_, at_) != c) return false;
    ++at_;
    skip_blanks();
    return true;
  }
  // A hyphen before a digit may be a sign, and one behind a word part of it.
  void take_dash_between_blanks() {
    const bool alone = at_ > 0 && is_blank(text_[at_ - 1]) && is_blank(char_at(text_, at_ + 1));
    if (alone) take('-');
  }
  void skip() {
    ++at_;
    skip_blanks();
  }

 private:
  template <typename Is>
  std::string_view take_while(Is is) {
    const std::size_t begin = at_;
    while (at_ < text_.size() && is(text_[at_])) ++at_;
    const std::string_view taken = text_.substr(begin, at_ - begin);
    skip_blanks();
    return taken;
  }
  void skip_blanks() { at_ = after_blanks(text_, at_); }

  std::string_view text_;
  std::size_t at_ = 0;
};

// Without brackets, semicolons and blanks around it, in capitals.
std::string words_of_comment(std::string_view comment) {
  std::string text = in_capitals(comment);
  if (text.starts_with('(')) {
    text.erase(0, 1);
    if (text.ends_with(')')) text.pop_back();
  }
  text.erase(0, std::min(text.find_first_not_of("; \t"), text.size()));
  text.erase(text.find_last_not_of(" \t\r") + 1);
  return text;
}

void take_separator(CommentCursor& cursor) {
  if (!cursor.take(':') && !cursor.take('=')) cursor.take_dash_between_blanks();
}

// What is said behind the name, and nothing more.
ToleranceWords length_behind_name(CommentCursor cursor) {
  take_separator(cursor);
  const auto value = length_in(cursor.number());
  const std::string_view unit = cursor.word();
  if (!value || !cursor.at_end()) return {Kind::kUncertain};
  if (unit.empty()) return stated(*value, Units::kUnknown);
  const auto known = std::ranges::find(kUnitNames, unit, &UnitName::name);
  return known == kUnitNames.end() ? ToleranceWords{Kind::kUncertain}
                                   : stated(*value, known->units);
}

bool is_number_behind(CommentCursor cursor) {
  take_separator(cursor);
  while (cursor.take('+') || cursor.take('-') || cursor.take('/')) {
  }
  return !cursor.number().empty();
}

// Whether a name stands anywhere with a number behind it.
bool names_a_number(const std::string& text) {
  CommentCursor cursor(text);
  while (!cursor.at_end()) {
    const std::string_view word = cursor.word();
    if (word.empty()) {
      cursor.skip();
    } else if ((is_one_of(word, kNames) || is_one_of(word, kNamesOfOneSide)) &&
               is_number_behind(cursor)) {
      return true;
    }
  }
  return false;
}

}  // namespace

ToleranceWords tolerance_in_comment(std::string_view comment) {
  const std::string text = words_of_comment(comment);
  // Nearly all comments: the search is quick.
  if (text.find("TOL") == std::string::npos) return {};
  CommentCursor cursor(text);
  CommentCursor behind_first = cursor;
  if (is_one_of(behind_first.word(), kBeforeName)) cursor = behind_first;
  const std::string_view name = cursor.word();
  if (is_one_of(name, kNames)) {
    const ToleranceWords words = length_behind_name(cursor);
    if (words.kind == Kind::kStated || name != kShortName) return words;
  }
  return {names_a_number(text) ? Kind::kUncertain : Kind::kNone};
}

ToleranceWords tolerance_in_cycle832(std::string_view block) {
  constexpr std::string_view kCycle = "CYCLE832";
  const std::string text = in_capitals(block.substr(0, block.find(';')));
  const std::size_t cycle = text.find(kCycle);
  if (cycle == std::string::npos) return {};
  if (cycle > 0 && is_name_character(text[cycle - 1])) return {};
  const std::string behind = without_blanks(std::string_view(text).substr(cycle + kCycle.size()));
  if (!behind.empty() && is_name_character(behind.front())) return {};
  if (behind.empty() || behind.starts_with("()")) return {Kind::kEnded};
  const std::size_t end = behind.find(')');
  if (!behind.starts_with('(') || end == std::string::npos) return {Kind::kUncertain};
  const std::string_view arguments = std::string_view(behind).substr(1, end - 1);
  const std::size_t comma = std::min(arguments.find(','), arguments.size());
  const std::string_view tolerance = arguments.substr(0, comma);
  const std::string_view rest = arguments.substr(std::min(comma + 1, arguments.size()));
  if (rest.substr(0, rest.find(',')) == "_OFF") return {Kind::kEnded};
  if (const auto zero = read_number(tolerance); zero && zero->value == 0) return {Kind::kEnded};
  const auto mm = length_in(tolerance);
  return mm ? stated(*mm, Units::kMillimetre) : ToleranceWords{Kind::kUncertain};
}

ToleranceWords tolerance_in_cycle32(std::string_view statement) {
  KlartextTokens tokens(statement);
  for (const std::string_view word : {"CYCL", "DEF", "32.1"}) {
    if (!is_same_word(tokens.next(), word)) return {};
  }
  const std::string_view token = tokens.next();
  if (token.empty()) return {Kind::kEnded};
  if (upper(token.front()) != 'T') return {Kind::kUncertain};
  std::string digits(token.size() > 1 ? token.substr(1) : tokens.next());
  if (digits.empty()) return {Kind::kEnded};
  if (digits.starts_with('+')) digits.erase(0, 1);
  std::ranges::replace(digits, ',', '.');
  const auto mm = length_in(digits);
  return mm ? stated(*mm, Units::kMillimetre) : ToleranceWords{Kind::kUncertain};
}

}  // namespace batten::gcode
