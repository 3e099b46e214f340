// The character classes of G-code, without the locale.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace batten::gcode {

[[nodiscard]] constexpr bool is_blank(char c) { return c == ' ' || c == '\t'; }
[[nodiscard]] constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
[[nodiscard]] constexpr bool is_letter(char c) {
  return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}
[[nodiscard]] constexpr char upper(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

[[nodiscard]] constexpr bool is_name_character(char c) {
  return is_letter(c) || is_digit(c) || c == '_';
}

// The character at this position; NUL after the end.
[[nodiscard]] constexpr char char_at(std::string_view text, std::size_t at) {
  return at < text.size() ? text[at] : '\0';
}

[[nodiscard]] constexpr std::size_t after_blanks(std::string_view text, std::size_t at) {
  while (is_blank(char_at(text, at))) ++at;
  return at;
}

[[nodiscard]] constexpr std::string_view without_blanks_before(std::string_view text) {
  return text.substr(std::min(after_blanks(text, 0), text.size()));
}

[[nodiscard]] inline std::string in_capitals(std::string_view text) {
  std::string capitals(text);
  std::ranges::transform(capitals, capitals.begin(), upper);
  return capitals;
}

[[nodiscard]] inline std::string without_blanks(std::string_view text) {
  std::string bare(text);
  std::erase_if(bare, is_blank);
  return bare;
}

// As much of a block as names it.
[[nodiscard]] inline std::string shown(std::string_view block) {
  constexpr std::size_t kMost = 40;
  const std::size_t begin = std::min(block.find_first_not_of(" \t\r\n"), block.size());
  block = block.substr(begin, block.find_last_not_of(" \t\r\n") + 1 - begin);
  return block.size() <= kMost ? std::string(block) : std::string(block.substr(0, kMost)) + "..";
}

// Whatever the case of its letters.
[[nodiscard]] constexpr bool is_same_word(std::string_view word, std::string_view upper_case) {
  return std::ranges::equal(word, upper_case, {}, upper);
}

// The bytes that some editors put before the first line of UTF-8.
inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace batten::gcode
