#include "gcode/siemens/lexer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

SourceSpan bytes(std::size_t begin, std::size_t end) {
  return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

std::size_t after_digits(std::string_view text, std::size_t at) {
  while (is_digit(char_at(text, at))) ++at;
  return at;
}

bool starts_number(char c) { return is_digit(c) || c == '.' || c == '+' || c == '-'; }

// Is the = at this place one that sets something (and no comparison)?
bool sets(std::string_view text, std::size_t at) {
  return at < text.size() && text[at] == '=' && (at + 1 >= text.size() || text[at + 1] != '=');
}

}  // namespace

SiemensToken SiemensLexer::token(SiemensTokenKind kind, std::size_t end) {
  SiemensToken token;
  token.kind = kind;
  token.span = bytes(at_, end);
  at_ = end;
  return token;
}

SiemensToken SiemensLexer::with_name(SiemensTokenKind kind, std::size_t name_end, std::size_t end) {
  const SourceSpan name = bytes(at_, name_end);
  SiemensToken named = token(kind, end);
  named.name = name;
  return named;
}

SiemensToken SiemensLexer::unreadable(std::string_view trouble) {
  SiemensToken found = token(SiemensTokenKind::kUnreadable, text_.size());
  found.trouble = trouble;
  return found;
}

SiemensToken SiemensLexer::next() {
  at_ = after_blanks(text_, at_);
  if (at_ >= text_.size()) {
    return token(SiemensTokenKind::kEnd, text_.size());
  }
  const char c = text_[at_];
  if (c == ';') {
    return token(SiemensTokenKind::kComment, text_.size());
  }
  if (c == '/' && !anything_) {
    const std::size_t end = at_ + (is_digit(char_at(text_, at_ + 1)) ? 2 : 1);
    return is_digit(char_at(text_, end)) ? unreadable("a block skip sign with a number above 9")
                                         : token(SiemensTokenKind::kSkip, end);
  }
  if (is_letter(c) || c == '_' || c == '$') {
    return address();
  }
  // :10 is a number of a main block, to which a jump may go as to a label.
  if (c == ':' && !anything_ && is_digit(char_at(text_, at_ + 1))) {
    const std::size_t end = after_digits(text_, at_ + 1);
    return with_name(SiemensTokenKind::kLabel, end, end);
  }
  if (c == '(') {
    return unreadable("a parenthesis without a name before it: comments start with ';' here");
  }
  return unreadable("a character that no word starts with");
}

SiemensToken SiemensLexer::address() {
  const char c = text_[at_];
  const char next = char_at(text_, at_ + 1);
  if (!is_letter(c) || is_letter(next) || next == '_' || next == '$' || next == '[' ||
      next == '(') {
    return named(after_siemens_name(text_, at_));
  }
  const std::size_t value = after_blanks(text_, at_ + 1);
  if (sets(text_, value)) {
    return assigned_letter(after_blanks(text_, value + 1));
  }
  // X1=10, M2=3: the digits are part of the address.
  const std::size_t digits = after_digits(text_, at_ + 1);
  const std::size_t behind = after_blanks(text_, digits);
  if (digits > at_ + 1 &&
      (sets(text_, behind) || char_at(text_, digits) == '_' || char_at(text_, digits) == '[')) {
    return named(after_siemens_name(text_, at_));
  }
  if (char_at(text_, value) == ':') {
    return named(at_ + 1);
  }
  if (digits > at_ + 1 && char_at(text_, behind) == ':' && upper(c) != 'N') {
    return named(digits);
  }
  const auto end = starts_number(char_at(text_, value)) ? after_siemens_number(text_, value)
                                                        : std::optional<std::size_t>();
  if (!end) {
    return unreadable("a letter without a number that can be read");
  }
  const auto number = number_in(value, *end);
  if (!number) return unreadable("a number of a thousand million or more");
  SiemensToken word = token(SiemensTokenKind::kWord, *end);
  word.letter = upper(c);
  word.number = *number;
  anything_ = anything_ || word.letter != 'N';
  return word;
}

std::optional<ReadNumber> SiemensLexer::number_in(std::size_t begin, std::size_t end) const {
  const auto number = read_number(text_.substr(begin, end - begin));
  return number && std::abs(number->value) < kNumberLimit ? number : std::nullopt;
}

SiemensToken SiemensLexer::assigned_letter(std::size_t value_at) {
  const char letter = upper(text_[at_]);
  const auto end = after_siemens_expression(text_, value_at);
  if (!end) {
    return unreadable("a value that cannot be read");
  }
  anything_ = true;
  const bool plain = after_siemens_number(text_, value_at) == end;
  const auto number = plain ? number_in(value_at, *end) : std::nullopt;
  SiemensToken word = token(number ? SiemensTokenKind::kWord : SiemensTokenKind::kValueWord, *end);
  word.letter = letter;
  word.assigned = true;
  if (number) word.number = *number;
  return word;
}

SiemensToken SiemensLexer::named(std::size_t name_end) {
  std::size_t end = name_end;
  if (const std::size_t colon = after_blanks(text_, end);
      char_at(text_, colon) == ':' && char_at(text_, colon + 1) != '=') {
    if (anything_) {
      return unreadable("a label after other words");
    }
    return with_name(SiemensTokenKind::kLabel, name_end, colon + 1);
  }
  if (const std::size_t index = after_blanks(text_, end); char_at(text_, index) == '[') {
    const auto closed = after_siemens_brackets(text_, index);
    if (!closed) {
      return unreadable("brackets that are not closed");
    }
    end = *closed;
  }
  bool assigned = false;
  bool arguments = false;
  if (const std::size_t equals = after_blanks(text_, end); sets(text_, equals)) {
    const auto closed = after_siemens_expression(text_, equals + 1);
    if (!closed) {
      return unreadable("a value that cannot be read");
    }
    assigned = true;
    end = *closed;
  } else if (char_at(text_, equals) == '(') {
    const auto closed = after_siemens_brackets(text_, equals);
    if (!closed) {
      return unreadable("brackets that are not closed");
    }
    arguments = after_blanks(text_, equals + 1) + 1 < *closed;
    end = *closed;
  }
  anything_ = true;
  SiemensToken found = with_name(SiemensTokenKind::kName, name_end, end);
  found.assigned = assigned;
  found.arguments = arguments;
  return found;
}

namespace {

constexpr std::array<std::string_view, 14> kSiemensWordOperators = {
    "DIV",  "MOD",   "AND",   "OR", "XOR", "NOT", "B_AND",
    "B_OR", "B_XOR", "B_NOT", "TO", "==",  "<>",  "<<"};

bool is_name_part(char c) { return is_name_character(c) || c == '$'; }

std::optional<std::size_t> after_string(std::string_view text, std::size_t at) {
  const std::size_t end = text.find('"', at + 1);
  return end == std::string_view::npos ? std::nullopt : std::optional(end + 1);
}

// The place after an operator, or nothing where none stands.
std::optional<std::size_t> after_siemens_operator(std::string_view text, std::size_t at) {
  const char c = char_at(text, at);
  if (is_letter(c)) {
    const std::size_t end = after_siemens_name(text, at);
    const std::string word = in_capitals(text.substr(at, end - at));
    const bool known = std::ranges::count(kSiemensWordOperators, word) > 0;
    return known ? std::optional(end) : std::nullopt;
  }
  if (c == '+' || c == '-' || c == '*' || c == '/') {
    return at + 1;
  }
  if (c == '=' && char_at(text, at + 1) == '=') {
    return at + 2;
  }
  if (c == '<' || c == '>') {
    const char next = char_at(text, at + 1);
    return at + (next == '=' || next == '>' || next == '<' ? 2 : 1);
  }
  return std::nullopt;
}

std::optional<std::size_t> after_siemens_operand(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  while (char_at(text, at) == '+' || char_at(text, at) == '-') {
    at = after_blanks(text, at + 1);
  }
  const char c = char_at(text, at);
  if (is_digit(c) || c == '.') {
    return after_siemens_number(text, at);
  }
  if (c == '"') {
    return after_string(text, at);
  }
  if (c == '(') {
    return after_siemens_brackets(text, at);
  }
  if (!is_letter(c) && c != '_' && c != '$') {
    return std::nullopt;
  }
  at = after_siemens_name(text, at);
  for (const char open : {'[', '('}) {
    const std::size_t bracket = after_blanks(text, at);
    if (char_at(text, bracket) != open) {
      continue;
    }
    const auto end = after_siemens_brackets(text, bracket);
    if (!end) {
      return std::nullopt;
    }
    at = *end;
  }
  return at;
}

}  // namespace

std::optional<std::size_t> after_siemens_number(std::string_view text, std::size_t at) {
  if (char_at(text, at) == '+' || char_at(text, at) == '-') ++at;
  const std::string_view rest = text.substr(std::min(at, text.size()));
  const std::size_t end = std::min(rest.find_first_not_of("0123456789."), rest.size());
  const auto points = std::ranges::count(rest.substr(0, end), '.');
  const bool any_digit = end > static_cast<std::size_t>(points);
  if (!any_digit || points > 1 || upper(char_at(rest, end)) == 'E') return std::nullopt;
  return at + end;
}

std::optional<std::size_t> after_siemens_brackets(std::string_view text, std::size_t at) {
  std::string open;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (c == '"') {
      const auto end = after_string(text, at);
      if (!end) {
        return std::nullopt;
      }
      at = *end - 1;
    } else if (c == '(' || c == '[') {
      open.push_back(c == '(' ? ')' : ']');
    } else if (c == ')' || c == ']') {
      if (open.empty() || open.back() != c) {
        return std::nullopt;
      }
      open.pop_back();
      if (open.empty()) {
        return at + 1;
      }
    } else if (c == ';') {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

std::size_t after_siemens_name(std::string_view text, std::size_t at) {
  while (is_name_part(char_at(text, at))) {
    ++at;
  }
  return at;
}

std::optional<std::size_t> after_siemens_expression(std::string_view text, std::size_t at) {
  auto end = after_siemens_operand(text, at);
  while (end) {
    const auto next = after_siemens_operator(text, after_blanks(text, *end));
    if (!next) break;
    end = after_siemens_operand(text, *next);
  }
  return end;
}

}  // namespace batten::gcode
