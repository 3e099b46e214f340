#include "gcode/rs274/lexer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "gcode/text/characters.h"

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

// Where parameters and expressions end, which are not computed. All functions take the position
// where something starts and give the one after it, or nothing when it is not there in full. Blanks
// are skipped.

using End = std::optional<std::size_t>;

constexpr std::array<std::string_view, 22> kFunctions = {
    "ABS", "ACOS", "ASIN",  "ATAN", "BCD", "BIN",  "COS", "EXISTS", "EXP",   "FIX", "FUP",
    "LN",  "POW",  "ROUND", "SIN",  "SQR", "SQRT", "TAN", "TRUNC",  "ATAN2", "MOD", "ADP"};

constexpr std::array<std::string_view, 10> kWordOperators = {"AND", "OR", "XOR", "MOD", "EQ",
                                                             "NE",  "GT", "GE",  "LT",  "LE"};

End after_number(std::string_view text, std::size_t at) {
  const auto number = scan_number(text.substr(at));
  return number ? End(at + number->length) : std::nullopt;
}

// [1+[2*3]], without comments or strings inside.
End after_brackets(std::string_view text, std::size_t at) {
  int depth = 0;
  for (at = after_blanks(text, at); at < text.size(); ++at) {
    const char c = text[at];
    if (c == '(' || c == ';' || c == '"' || c == '\'' || (depth == 0 && c != '[')) break;
    depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (depth == 0) return at + 1;
  }
  return std::nullopt;
}

// #5  ##5  #<name>  #[1+2]
End after_parameter(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (char_at(text, at) != '#') return std::nullopt;
  while (char_at(text, at) == '#') at = after_blanks(text, at + 1);
  if (is_digit(char_at(text, at))) return after_number(text, at);
  if (char_at(text, at) != '<') return after_brackets(text, at);
  const std::size_t close = text.find_first_of(">(;", at);
  return char_at(text, close) == '>' ? End(close + 1) : std::nullopt;
}

// SIN[30], FIX[#1]: a function's name and its brackets. ATAN[1]/[2] is two operands.
End after_function(std::string_view text, std::size_t at) {
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

// A value that a letter may take in place of a number: an optional sign, then a parameter,
// brackets or a function.
End after_computed_value(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (char_at(text, at) == '-' || char_at(text, at) == '+') at = after_blanks(text, at + 1);
  const char c = char_at(text, at);
  return c == '#'   ? after_parameter(text, at)
         : c == '[' ? after_brackets(text, at)
                    : after_function(text, at);
}

// HA, DB: Okuma's offsets of the tool in the spindle, of its set A, B or C.
bool is_offset_of_tool(std::string_view text, std::size_t at) {
  const char letter = upper(char_at(text, at));
  const char set = upper(char_at(text, at + 1));
  return (letter == 'H' || letter == 'D') && set >= 'A' && set <= 'C' &&
         !is_name_character(char_at(text, at + 2));
}

// R5, R[1], as Siemens names its parameters.
End after_r_parameter(std::string_view text, std::size_t at) {
  if (upper(char_at(text, at)) != 'R') {
    return std::nullopt;
  }
  const std::size_t value = after_blanks(text, at + 1);
  return is_digit(char_at(text, value)) ? after_number(text, value) : after_brackets(text, value);
}

End after_operand(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  End end = after_number(text, at);
  if (!end) end = after_computed_value(text, at);
  const char c = char_at(text, at);
  const std::size_t parameter = c == '-' || c == '+' ? after_blanks(text, at + 1) : at;
  return end ? end : after_r_parameter(text, parameter);
}

End after_operator(std::string_view text, std::size_t at) {
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

// The right side of an assignment: values, numbers and R parameters, joined by operators.
End after_sum(std::string_view text, std::size_t at) {
  End end = after_operand(text, at);
  while (end) {
    const End operation = after_operator(text, *end);
    if (!operation) break;
    end = after_operand(text, *operation);
  }
  return end;
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
      return take(TokenKind::kLineComment, text_.size());
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
  if (c == '#' || c == '[' || (is_letter(c) && after_function(text_, value))) {
    return value_word(letter, value);
  }
  if (at_ > begin_ && is_offset_of_tool(text_, at_)) {
    take(TokenKind::kValueWord, at_ + 2);
    token_.letter = letter;
    return token_;
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
  const char next = char_at(text_, following);
  if (next == '=' && letter == 'R') return assigned(following);
  if (next == '=' || next == '_') return rest(TokenKind::kForeign, at_);
  if (next == ':') return rest(TokenKind::kFlow, at_);
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
  const std::size_t first_close = text_.find(')', at_);
  const bool nested =
      text_.substr(at_ + 1, first_close - at_ - 1).find('(') != std::string_view::npos;
  std::size_t end = at_;
  int depth = 0;
  do {
    depth += text_[end] == '(' ? 1 : text_[end] == ')' ? -1 : 0;
    ++end;
  } while (depth > 0 && end < text_.size());
  // Where nothing closes it, words behind the first closing bracket would be read by some controls.
  const std::size_t said = depth == 0 ? end : first_close + 1;
  const bool closed = first_close != std::string_view::npos;
  if (closed && (nested || depth > 0) && after_blanks(text_, said) < text_.size()) {
    return unreadable(at_, "a comment in a comment, and words after it");
  }
  take(TokenKind::kComment, end);
  token_.unclosed = !closed;
  return token_;
}

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
  if (std::string_view("RCAK").find(letter) == std::string_view::npos) {
    return unreadable(at_, "a comma without a corner word (,R ,C ,A ,K)");
  }
  const auto scanned =
      value < text_.size() ? scan_number(text_.substr(value)) : std::optional<ScannedNumber>();
  const End computed = scanned ? End(value + scanned->length) : after_computed_value(text_, value);
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

bool is_active_comment(std::string_view comment) {
  // What the text starts with, blanks left out. A comma is part of it where controls ask for one:
  // (print this first) is only text.
  constexpr std::array<std::string_view, 17> kBeginnings = {
      "MSG,",     "DEBUG,",    "PRINT,",  "LOG,",     "LOGOPEN", "LOGAPPEND",
      "LOGCLOSE", "PROBEOPEN", "PROBECL", "PY,",      "PYRUN,",  "PYRELOAD",
      "ABORT,",   "SYSTEM,",   "AXIS,",   "WARNING,", "ERROR,"};
  constexpr std::size_t kLongest = 9;
  std::string beginning;
  for (std::size_t at = 1; at < comment.size() && beginning.size() < kLongest; ++at) {
    if (!is_blank(comment[at])) beginning.push_back(upper(comment[at]));
  }
  return std::ranges::any_of(kBeginnings,
                             [&](std::string_view name) { return beginning.starts_with(name); });
}

}  // namespace batten::gcode
