#include "gcode/rs274/expression.h"

#include <algorithm>
#include <array>

#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::gcode {
namespace {

using Place = std::optional<std::size_t>;

constexpr std::array<std::string_view, 22> kFunctions = {
    "ABS", "ACOS", "ASIN",  "ATAN", "BCD", "BIN",  "COS", "EXISTS", "EXP",   "FIX", "FUP",
    "LN",  "POW",  "ROUND", "SIN",  "SQR", "SQRT", "TAN", "TRUNC",  "ATAN2", "MOD", "ADP"};

constexpr std::array<std::string_view, 10> kWordOperators = {"AND", "OR", "XOR", "MOD", "EQ",
                                                             "NE",  "GT", "GE",  "LT",  "LE"};

char peek(std::string_view text, std::size_t at) { return at < text.size() ? text[at] : '\0'; }

std::size_t after_blanks(std::string_view text, std::size_t at) {
  while (at < text.size() && is_blank(text[at])) {
    ++at;
  }
  return at;
}

bool starts_with(std::string_view text, std::size_t at, std::string_view name) {
  if (text.size() - at < name.size()) {
    return false;
  }
  return std::equal(name.begin(), name.end(), text.begin() + static_cast<std::ptrdiff_t>(at),
                    [](char a, char b) { return a == upper(b); });
}

Place after_number(std::string_view text, std::size_t at) {
  const auto number = scan_number(text.substr(at));
  return number ? Place(at + number->length) : std::nullopt;
}

// R5, R[1], as Siemens names its parameters.
Place after_r_parameter(std::string_view text, std::size_t at) {
  if (upper(peek(text, at)) != 'R') {
    return std::nullopt;
  }
  const std::size_t value = after_blanks(text, at + 1);
  return is_digit(peek(text, value)) ? after_number(text, value) : after_brackets(text, value);
}

Place after_operand(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (const Place number = after_number(text, at)) {
    return number;
  }
  if (const Place value = after_computed_value(text, at)) {
    return value;
  }
  const char c = peek(text, at);
  return after_r_parameter(text, c == '-' || c == '+' ? after_blanks(text, at + 1) : at);
}

Place after_operator(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  const char c = peek(text, at);
  if (c == '*' && peek(text, at + 1) == '*') {
    return at + 2;
  }
  if (c == '+' || c == '-' || c == '*' || c == '/') {
    return at + 1;
  }
  for (const std::string_view name : kWordOperators) {
    if (at < text.size() && starts_with(text, at, name)) {
      return at + name.size();
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::size_t> after_brackets(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (peek(text, at) != '[') {
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
  if (peek(text, at) != '#') {
    return std::nullopt;
  }
  while (peek(text, at) == '#') {
    at = after_blanks(text, at + 1);
  }
  if (peek(text, at) == '<') {
    const std::size_t close = text.find_first_of(">(;", at);
    const bool closed = close != std::string_view::npos && text[close] == '>';
    return closed ? Place(close + 1) : std::nullopt;
  }
  if (peek(text, at) == '[') {
    return after_brackets(text, at);
  }
  return is_digit(peek(text, at)) ? after_number(text, at) : std::nullopt;
}

std::optional<std::size_t> after_function(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  std::size_t end = at;
  while (is_letter(peek(text, end)) || (end > at && is_digit(peek(text, end)))) {
    ++end;
  }
  const bool known = std::any_of(kFunctions.begin(), kFunctions.end(), [&](std::string_view name) {
    return name.size() == end - at && starts_with(text, at, name);
  });
  return known ? after_brackets(text, end) : std::nullopt;
}

std::optional<std::size_t> after_computed_value(std::string_view text, std::size_t at) {
  at = after_blanks(text, at);
  if (peek(text, at) == '-' || peek(text, at) == '+') {
    at = after_blanks(text, at + 1);
  }
  switch (peek(text, at)) {
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

}  // namespace batten::gcode
