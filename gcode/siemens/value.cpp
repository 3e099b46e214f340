#include "gcode/siemens/value.h"

#include <algorithm>
#include <array>
#include <string>

#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

constexpr std::array<std::string_view, 14> kSiemensWordOperators = {
    "DIV",  "MOD",   "AND",   "OR", "XOR", "NOT", "B_AND",
    "B_OR", "B_XOR", "B_NOT", "TO", "==",  "<>",  "<<"};

char char_at(std::string_view text, std::size_t at) { return at < text.size() ? text[at] : '\0'; }

std::size_t skip_siemens_blanks(std::string_view text, std::size_t at) {
  while (is_blank(char_at(text, at))) {
    ++at;
  }
  return at;
}

bool is_name_part(char c) { return is_letter(c) || is_digit(c) || c == '_' || c == '$'; }

std::optional<std::size_t> after_string(std::string_view text, std::size_t at) {
  const std::size_t end = text.find('"', at + 1);
  return end == std::string_view::npos ? std::nullopt : std::optional(end + 1);
}

// The place after an operator, or nothing where none stands.
std::optional<std::size_t> after_siemens_operator(std::string_view text, std::size_t at) {
  const char c = char_at(text, at);
  if (is_letter(c)) {
    std::string word;
    const std::size_t end = after_siemens_name(text, at);
    for (std::size_t i = at; i < end; ++i) {
      word.push_back(upper(text[i]));
    }
    const bool known =
        std::ranges::find(kSiemensWordOperators, word) != kSiemensWordOperators.end();
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
  at = skip_siemens_blanks(text, at);
  while (char_at(text, at) == '+' || char_at(text, at) == '-') {
    at = skip_siemens_blanks(text, at + 1);
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
    const std::size_t bracket = skip_siemens_blanks(text, at);
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
  if (char_at(text, at) == '+' || char_at(text, at) == '-') {
    ++at;
  }
  std::size_t digits = 0;
  bool point = false;
  for (; is_digit(char_at(text, at)) || (!point && char_at(text, at) == '.'); ++at) {
    point = point || text[at] == '.';
    digits += text[at] == '.' ? 0U : 1U;
  }
  const char next = char_at(text, at);
  if (digits == 0 || next == '.' || upper(next) == 'E') {
    return std::nullopt;
  }
  return at;
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
    const auto next = after_siemens_operator(text, skip_siemens_blanks(text, *end));
    if (!next) {
      return end;
    }
    end = after_siemens_operand(text, *next);
  }
  return std::nullopt;
}

}  // namespace batten::gcode
