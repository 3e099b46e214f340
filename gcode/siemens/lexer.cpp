#include "gcode/siemens/lexer.h"

#include <cmath>
#include <optional>

#include "gcode/siemens/value.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_limit.h"

namespace batten::gcode {
namespace {

SourceSpan bytes(std::size_t begin, std::size_t end) {
  return {static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(end)};
}

bool starts_number(char c) { return is_digit(c) || c == '.' || c == '+' || c == '-'; }

// Is the = at this place one that sets something (and no comparison)?
bool sets(std::string_view text, std::size_t at) {
  return at < text.size() && text[at] == '=' && (at + 1 >= text.size() || text[at + 1] != '=');
}

}  // namespace

std::size_t SiemensLexer::after_blanks(std::size_t at) const {
  while (is_blank(peek(at))) {
    ++at;
  }
  return at;
}

SiemensToken SiemensLexer::token(SiemensTokenKind kind, std::size_t end) {
  SiemensToken token;
  token.kind = kind;
  token.span = bytes(at_, end);
  at_ = end;
  return token;
}

SiemensToken SiemensLexer::unreadable(std::string_view trouble) {
  SiemensToken found = token(SiemensTokenKind::kUnreadable, text_.size());
  found.trouble = trouble;
  return found;
}

SiemensToken SiemensLexer::next() {
  at_ = after_blanks(at_);
  if (at_ >= text_.size()) {
    return token(SiemensTokenKind::kEnd, text_.size());
  }
  const char c = text_[at_];
  if (c == ';') {
    return token(SiemensTokenKind::kComment, text_.size());
  }
  if (c == '/' && !anything_) {
    const std::size_t end = at_ + (is_digit(peek(at_ + 1)) ? 2 : 1);
    return is_digit(peek(end)) ? unreadable("a block skip sign with a number above 9")
                               : token(SiemensTokenKind::kSkip, end);
  }
  if (is_letter(c) || c == '_' || c == '$') {
    return address();
  }
  if (c == ':' && !anything_ && is_digit(peek(at_ + 1))) {
    return main_block();
  }
  if (c == '(') {
    return unreadable("a parenthesis without a name before it: comments start with ';' here");
  }
  return unreadable("a character that no word starts with");
}

// :10 is a number of a main block, to which a jump may go as to a label.
SiemensToken SiemensLexer::main_block() {
  std::size_t end = at_ + 1;
  while (is_digit(peek(end))) {
    ++end;
  }
  const SourceSpan name = bytes(at_, end);
  SiemensToken label = token(SiemensTokenKind::kLabel, end);
  label.name = name;
  return label;
}

SiemensToken SiemensLexer::address() {
  const char c = text_[at_];
  const char next = peek(at_ + 1);
  if (!is_letter(c) || is_letter(next) || next == '_' || next == '$' || next == '[' ||
      next == '(') {
    return named(after_siemens_name(text_, at_));
  }
  const std::size_t value = after_blanks(at_ + 1);
  if (sets(text_, value)) {
    return assigned_letter(after_blanks(value + 1));
  }
  // X1=10, M2=3: the digits are part of the address.
  std::size_t digits = at_ + 1;
  while (is_digit(peek(digits))) {
    ++digits;
  }
  const std::size_t behind = after_blanks(digits);
  if (digits > at_ + 1 && (sets(text_, behind) || peek(digits) == '_' || peek(digits) == '[')) {
    return named(after_siemens_name(text_, at_));
  }
  if (peek(value) == ':') {
    return named(at_ + 1);
  }
  if (digits > at_ + 1 && peek(behind) == ':' && upper(c) != 'N') {
    return named(digits);
  }
  const auto end = starts_number(peek(value)) ? after_siemens_number(text_, value)
                                              : std::optional<std::size_t>();
  if (!end) {
    return unreadable("a letter without a number that can be read");
  }
  const auto number = read_number(text_.substr(value, *end - value));
  if (!number || std::abs(number->value) >= kNumberLimit) {
    return unreadable("a number of a thousand million or more");
  }
  SiemensToken word = token(SiemensTokenKind::kWord, *end);
  word.letter = upper(c);
  word.number = *number;
  anything_ = anything_ || word.letter != 'N';
  return word;
}

SiemensToken SiemensLexer::assigned_letter(std::size_t value_at) {
  const char letter = upper(text_[at_]);
  const auto end = after_siemens_expression(text_, value_at);
  if (!end) {
    return unreadable("a value that cannot be read");
  }
  anything_ = true;
  const bool plain = after_siemens_number(text_, value_at) == end;
  const auto number =
      plain ? read_number(text_.substr(value_at, *end - value_at)) : std::optional<ReadNumber>();
  const bool readable = number && std::abs(number->value) < kNumberLimit;
  SiemensToken word =
      token(readable ? SiemensTokenKind::kWord : SiemensTokenKind::kValueWord, *end);
  word.letter = letter;
  word.assigned = true;
  if (readable) {
    word.number = *number;
  }
  return word;
}

SiemensToken SiemensLexer::named(std::size_t name_end) {
  const SourceSpan name = bytes(at_, name_end);
  std::size_t end = name_end;
  if (const std::size_t colon = after_blanks(end); peek(colon) == ':' && peek(colon + 1) != '=') {
    if (anything_) {
      return unreadable("a label behind other words");
    }
    SiemensToken label = token(SiemensTokenKind::kLabel, colon + 1);
    label.name = name;
    return label;
  }
  if (const std::size_t index = after_blanks(end); peek(index) == '[') {
    const auto closed = after_siemens_brackets(text_, index);
    if (!closed) {
      return unreadable("brackets that are not closed");
    }
    end = *closed;
  }
  bool assigned = false;
  bool arguments = false;
  if (const std::size_t equals = after_blanks(end); sets(text_, equals)) {
    const auto closed = after_siemens_expression(text_, equals + 1);
    if (!closed) {
      return unreadable("a value that cannot be read");
    }
    assigned = true;
    end = *closed;
  } else if (peek(equals) == '(') {
    const auto closed = after_siemens_brackets(text_, equals);
    if (!closed) {
      return unreadable("brackets that are not closed");
    }
    arguments = after_blanks(equals + 1) + 1 < *closed;
    end = *closed;
  }
  anything_ = true;
  SiemensToken found = token(SiemensTokenKind::kName, end);
  found.name = name;
  found.assigned = assigned;
  found.arguments = arguments;
  return found;
}

}  // namespace batten::gcode
