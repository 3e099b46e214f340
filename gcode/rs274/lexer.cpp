#include "gcode/rs274/lexer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

// Words of several letters that change the order in which blocks run, in macro B, in the
// languages of Siemens and Okuma, and (after their O) in LinuxCNC.
constexpr std::array<std::string_view, 22> kFlowWords = {
    "IF",    "THEN",  "ELSE",   "ELSEIF",  "ENDIF",    "WHILE",  "DO",     "END",
    "GOTO",  "GOTOF", "GOTOB",  "GOTOC",   "GOTOS",    "FOR",    "ENDFOR", "LOOP",
    "UNTIL", "CASE",  "REPEAT", "ENDLOOP", "ENDWHILE", "REPEATB"};

// Characters that no word of the RS-274 family starts with, but words of other languages do:
// strings, settings ($), JSON, host commands, polar words (@ ^), assignments, continuation.
constexpr std::string_view kForeignCharacters = "\"'$!{}@^<>=~&|?\\`_";

SourceSpan span_of(std::size_t begin, std::size_t end) {
  return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

}  // namespace

const Token& LineLexer::take(TokenKind kind, std::size_t end) {
  token_.kind = kind;
  token_.letter = 0;
  token_.has_value = false;
  token_.unclosed = false;
  token_.span = span_of(at_, end);
  at_ = end;
  return token_;
}

// Field by field: a copy of the whole would wait until the parts have been written.
void LineLexer::take_number(const ReadNumber& number) {
  token_.has_value = true;
  token_.number.value = number.value;
  token_.number.decimals = number.decimals;
  token_.number.has_point = number.has_point;
}

const Token& LineLexer::rest(TokenKind kind, std::size_t where) {
  at_ = where;
  return take(kind, text_.size());
}

const Token& LineLexer::unreadable(std::size_t where, std::string_view trouble) {
  rest(TokenKind::kUnreadable, where);
  token_.trouble = trouble;
  return token_;
}

const Token& LineLexer::next() {
  at_ = after_blanks(text_, at_);
  if (at_ >= text_.size()) {
    return take(TokenKind::kEnd, text_.size());
  }
  const char c = text_[at_];
  return is_letter(c) ? letter_token() : sign_token(c);
}

const Token& LineLexer::sign_token(char c) {
  switch (c) {
    case '(':
      return comment();
    case ';':
      return line_comment();
    case '/':
      return block_delete();
    case '*':
      if (at_ > begin_) {
        return checksum();
      }
      break;
    case ',':
      return corner_word();
    case '#':
      return parameter_assignment();
    case ':':  // ISO code writes it for the O of a program number; labels end in it
      return at_ == begin_ ? o_word() : rest(TokenKind::kFlow, at_);
    case ')':
      return unreadable(at_, "')' without '('");
    default:
      break;
  }
  const bool first = at_ == begin_;
  if (kForeignCharacters.find(c) != std::string_view::npos ||
      (first && (is_digit(c) || c == '*'))) {
    return rest(TokenKind::kForeign, at_);  // Klartext lines start with digits or a star
  }
  if (is_digit(c) || c == '.' || c == '+' || c == '-') {
    return unreadable(at_, "a number without a letter");
  }
  return unreadable(at_, "a character that no word starts with");
}

const Token& LineLexer::letter_token() {
  const char letter = upper(text_[at_]);
  const std::size_t value = after_blanks(text_, at_ + 1);
  const char c = char_at(text_, value);
  if (letter == 'O') {
    return o_word();
  }
  if (is_digit(c) || c == '.') {
    return number_word(letter, value);
  }
  if (c == '+' || c == '-') {
    return scan_number(text_.substr(value)) ? number_word(letter, value)
                                            : value_word(letter, value);
  }
  if (c == '#' || c == '[') {
    return value_word(letter, value);
  }
  if (is_letter(c) && after_function(text_, value)) {
    return value_word(letter, value);
  }
  if (value == at_ + 1 && is_name_character(c)) {
    return keyword();
  }
  if (c == '=') {
    return rest(TokenKind::kForeign, at_);
  }
  if (c == ':') {
    return rest(TokenKind::kFlow, at_);
  }
  return unreadable(at_, "a letter without a number");
}

const Token& LineLexer::number_word(char letter, std::size_t value_at) {
  const auto scanned = scan_number(text_.substr(value_at));
  if (!scanned) {
    return unreadable(at_, "a letter without a number that can be read");
  }
  if (std::abs(scanned->number.value) >= kNumberLimit) {
    return unreadable(at_, "a number of a thousand million or more");
  }
  const std::size_t end = value_at + scanned->length;
  const char glued = char_at(text_, end);
  if (upper(glued) == 'E') {
    // X1E3: an exponent for some, the word E3 for others. E apart (X1 E3) is a word for all.
    return unreadable(end, "an E right after a number, which may be an exponent or a word");
  }
  const std::size_t following = after_blanks(text_, end);
  switch (char_at(text_, following)) {
    case '=':
      return letter == 'R' ? assigned(following) : rest(TokenKind::kForeign, at_);
    case ':':
      return rest(TokenKind::kFlow, at_);
    case '_':
      return rest(TokenKind::kForeign, at_);
    default:
      break;
  }
  take(TokenKind::kWord, end);
  token_.letter = letter;
  take_number(scanned->number);
  return token_;
}

const Token& LineLexer::value_word(char letter, std::size_t value_at) {
  const auto end = after_computed_value(text_, value_at);
  if (!end) {
    return unreadable(at_, "a letter without a value that can be read");
  }
  take(TokenKind::kValueWord, *end);
  token_.letter = letter;
  return token_;
}

// O1000 alone is a program's number; with anything else (O100 sub, O<name> call) the order of
// blocks changes.
const Token& LineLexer::o_word() {
  const std::size_t value = after_blanks(text_, at_ + 1);
  const auto scanned = is_digit(char_at(text_, value)) ? scan_number(text_.substr(value))
                                                       : std::optional<ScannedNumber>();
  if (!scanned) {
    return rest(TokenKind::kFlow, at_);
  }
  const std::size_t end = value + scanned->length;
  const std::size_t following = after_blanks(text_, end);
  const char c = char_at(text_, following);
  if (following < text_.size() && c != '(' && c != ';') {
    return rest(TokenKind::kFlow, at_);
  }
  take(TokenKind::kProgramNumber, end);
  token_.letter = 'O';
  take_number(scanned->number);
  return token_;
}

// Two letters without anything between them: no word of the RS-274 family.
const Token& LineLexer::keyword() {
  std::size_t end = at_;
  while (is_letter(char_at(text_, end))) {
    ++end;
  }
  const std::string_view word = text_.substr(at_, end - at_);
  while (is_name_character(char_at(text_, end))) {
    ++end;
  }
  const bool label = char_at(text_, after_blanks(text_, end)) == ':';
  const bool flow = std::ranges::any_of(
      kFlowWords, [word](std::string_view each) { return is_same_word(word, each); });
  return rest(label || flow ? TokenKind::kFlow : TokenKind::kForeign, at_);
}

// Ends with its own closing bracket. Nested comments are an error for most controls and one
// comment for some (ISG): read as one when the brackets balance, which nobody reads as words.
const Token& LineLexer::comment() {
  std::size_t first_close = 0;
  int depth = 0;
  bool nested = false;
  std::size_t at = at_;
  for (; at < text_.size(); ++at) {
    if (text_[at] == '(') {
      nested = nested || depth > 0;
      ++depth;
    } else if (text_[at] == ')') {
      first_close = first_close == 0 ? at : first_close;
      if (--depth == 0) {
        break;
      }
    }
  }
  if (depth == 0) {
    const bool more = nested && after_blanks(text_, at + 1) < text_.size();
    return more ? unreadable(at_, "a comment in a comment, and words after it")
                : take(TokenKind::kComment, at + 1);
  }
  if (first_close != 0 && after_blanks(text_, first_close + 1) < text_.size()) {
    return unreadable(at_, "a comment in a comment, and words after it");
  }
  take(TokenKind::kComment, text_.size());
  token_.unclosed = first_close == 0;
  return token_;
}

const Token& LineLexer::line_comment() { return take(TokenKind::kLineComment, text_.size()); }

const Token& LineLexer::block_delete() {
  const std::size_t end = is_digit(char_at(text_, at_ + 1)) ? at_ + 2 : at_ + 1;
  if (is_digit(char_at(text_, end)) || char_at(text_, end) == '.') {
    return unreadable(at_, "a block delete sign with a number above 9");
  }
  return take(TokenKind::kBlockDelete, end);
}

const Token& LineLexer::checksum() {
  constexpr std::size_t kMostDigits = 3;  // a sum is a byte
  std::size_t end = at_ + 1;
  while (is_digit(char_at(text_, end))) {
    ++end;
  }
  const std::size_t digits = end - at_ - 1;
  if (digits == 0 || digits > kMostDigits || after_blanks(text_, end) < text_.size()) {
    return unreadable(at_, "a '*' that is no check sum");
  }
  const auto scanned = scan_number(text_.substr(at_ + 1, digits));
  take(TokenKind::kChecksum, end);
  take_number(scanned->number);
  return token_;
}

const Token& LineLexer::parameter_assignment() {
  const auto target = after_parameter(text_, at_);
  if (!target) {
    // #SPLINE ON, #HSC, #set(..)#: commands of other controls.
    const bool command = is_letter(char_at(text_, after_blanks(text_, at_ + 1)));
    return command ? rest(TokenKind::kForeign, at_)
                   : unreadable(at_, "a '#' without a parameter after it");
  }
  const std::size_t equals = after_blanks(text_, *target);
  if (char_at(text_, equals) != '=') {
    return unreadable(at_, "a parameter that is neither a value nor set");
  }
  return assigned(equals);
}

const Token& LineLexer::assigned(std::size_t equals_at) {
  const auto end = after_sum(text_, equals_at + 1);
  return end ? take(TokenKind::kAssignment, *end)
             : unreadable(at_, "a parameter that is set to something that cannot be read");
}

const Token& LineLexer::corner_word() {
  const std::size_t letter_at = after_blanks(text_, at_ + 1);
  const char letter = upper(char_at(text_, letter_at));
  const std::size_t value = after_blanks(text_, letter_at + 1);
  if (letter != 'R' && letter != 'C' && letter != 'A') {
    return unreadable(at_, "a comma without a corner word (,R ,C ,A)");
  }
  const auto scanned =
      value < text_.size() ? scan_number(text_.substr(value)) : std::optional<ScannedNumber>();
  const auto computed = scanned ? std::optional<std::size_t>(value + scanned->length)
                                : after_computed_value(text_, value);
  if (!computed) {
    return unreadable(at_, "a corner word without a value that can be read");
  }
  take(TokenKind::kCornerWord, *computed);
  token_.letter = letter;
  if (scanned) {
    take_number(scanned->number);
  }
  return token_;
}

namespace {

using Place = std::optional<std::size_t>;

constexpr std::array<std::string_view, 22> kFunctions = {
    "ABS", "ACOS", "ASIN",  "ATAN", "BCD", "BIN",  "COS", "EXISTS", "EXP",   "FIX", "FUP",
    "LN",  "POW",  "ROUND", "SIN",  "SQR", "SQRT", "TAN", "TRUNC",  "ATAN2", "MOD", "ADP"};

constexpr std::array<std::string_view, 10> kWordOperators = {"AND", "OR", "XOR", "MOD", "EQ",
                                                             "NE",  "GT", "GE",  "LT",  "LE"};

Place after_number(std::string_view text, std::size_t at) {
  const auto number = scan_number(text.substr(at));
  return number ? Place(at + number->length) : std::nullopt;
}

// R5, R[1], as Siemens names its parameters.
Place after_r_parameter(std::string_view text, std::size_t at) {
  if (upper(char_at(text, at)) != 'R') {
    return std::nullopt;
  }
  const std::size_t value = after_blanks(text, at + 1);
  return is_digit(char_at(text, value)) ? after_number(text, value) : after_brackets(text, value);
}

Place after_operand(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (const Place number = after_number(text, at)) {
    return number;
  }
  if (const Place value = after_computed_value(text, at)) {
    return value;
  }
  const char c = char_at(text, at);
  return after_r_parameter(text, c == '-' || c == '+' ? after_blanks(text, at + 1) : at);
}

Place after_operator(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  const char c = char_at(text, at);
  if (c == '*' && char_at(text, at + 1) == '*') {
    return at + 2;
  }
  if (c == '+' || c == '-' || c == '*' || c == '/') {
    return at + 1;
  }
  for (const std::string_view name : kWordOperators) {
    if (at < text.size() && is_same_word(text.substr(at, name.size()), name)) {
      return at + name.size();
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::size_t> after_brackets(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (char_at(text, at) != '[') {
    return std::nullopt;
  }
  int depth = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '(' || c == ';' || c == '"' || c == '\'') {
      return std::nullopt;
    }
    depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (depth == 0) {
      return at + 1;
    }
  }
  return std::nullopt;
}

std::optional<std::size_t> after_parameter(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (char_at(text, at) != '#') {
    return std::nullopt;
  }
  while (char_at(text, at) == '#') {
    at = after_blanks(text, at + 1);
  }
  if (char_at(text, at) == '<') {
    const std::size_t close = text.find_first_of(">(;", at);
    const bool closed = close != std::string_view::npos && text[close] == '>';
    return closed ? Place(close + 1) : std::nullopt;
  }
  if (char_at(text, at) == '[') {
    return after_brackets(text, at);
  }
  return is_digit(char_at(text, at)) ? after_number(text, at) : std::nullopt;
}

std::optional<std::size_t> after_function(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  std::size_t end = at;
  while (is_letter(char_at(text, end)) || (end > at && is_digit(char_at(text, end)))) {
    ++end;
  }
  const bool known = std::ranges::any_of(kFunctions, [&](std::string_view name) {
    return is_same_word(text.substr(at, end - at), name);
  });
  return known ? after_brackets(text, end) : std::nullopt;
}

std::optional<std::size_t> after_computed_value(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (char_at(text, at) == '-' || char_at(text, at) == '+') {
    at = after_blanks(text, at + 1);
  }
  switch (char_at(text, at)) {
    case '#':
      return after_parameter(text, at);
    case '[':
      return after_brackets(text, at);
    default:
      return after_function(text, at);
  }
}

std::optional<std::size_t> after_sum(std::string_view text, std::size_t at) {
  Place end = after_operand(text, at);
  while (end) {
    const Place operation = after_operator(text, *end);
    if (!operation) {
      return end;
    }
    end = after_operand(text, *operation);
  }
  return std::nullopt;
}

namespace {

// What the text of an active comment starts with, blanks left out. A comma is part of it
// where controls ask for one: (print this first) is only text.
constexpr std::array<std::string_view, 17> kBeginnings = {
    "MSG,",     "DEBUG,",    "PRINT,",  "LOG,",     "LOGOPEN", "LOGAPPEND",
    "LOGCLOSE", "PROBEOPEN", "PROBECL", "PY,",      "PYRUN,",  "PYRELOAD",
    "ABORT,",   "SYSTEM,",   "AXIS,",   "WARNING,", "ERROR,"};

constexpr std::size_t kLongest = 9;

}  // namespace

bool is_active_comment(std::string_view comment) {
  std::array<char, kLongest> beginning{};
  std::size_t length = 0;
  for (std::size_t at = 1; at < comment.size() && length < kLongest; ++at) {
    if (!is_blank(comment[at])) {
      beginning[length++] = upper(comment[at]);
    }
  }
  const std::string_view text(beginning.data(), length);
  return std::any_of(kBeginnings.begin(), kBeginnings.end(),
                     [&](std::string_view name) { return text.starts_with(name); });
}

}  // namespace batten::gcode
