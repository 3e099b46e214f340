// The character classes of G-code, without the locale.
#pragma once

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

// The bytes that some editors put before the first line of UTF-8.

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace batten::gcode
