#include "gcode/text/number_format.h"

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "gcode/text/characters.h"

namespace batten::gcode {
namespace {

constexpr int kMostDecimals = 9;

void check(double value, int decimals) {
  if (!(std::abs(value) < kNumberLimit)) {
    throw std::invalid_argument("number_format: " + std::to_string(value) +
                                ", expected a number below 1e9");
  }
  if (decimals < 0 || decimals > kMostDecimals) {
    throw std::invalid_argument("number_format: " + std::to_string(decimals) +
                                " decimals, expected 0 to 9");
  }
}

// The shortest decimal that means this double and no other, with so many digits after the
// point: half goes away from zero.
std::string rounded_decimal(double size, int decimals) {
  std::array<char, 400> shortest{};  // the least double has 324 digits after the point
  const auto written = std::to_chars(shortest.data(), shortest.data() + shortest.size(), size,
                                     std::chars_format::fixed);
  std::string text(shortest.data(), written.ptr);
  if (text.find('.') == std::string::npos) text += '.';
  const std::size_t end = text.find('.') + 1 + static_cast<std::size_t>(decimals);
  bool up = text.size() > end && text[end] >= '5';
  text.resize(end, '0');
  for (std::size_t i = end; up && i-- > 0;) {
    if (text[i] == '.') continue;
    up = text[i] == '9';
    text[i] = up ? '0' : static_cast<char>(text[i] + 1);
  }
  return up ? "1" + text : text;
}

}  // namespace

void append_number(std::string& out, double value, const NumberFormat& format) {
  check(value, format.decimals);
  std::string text = rounded_decimal(std::abs(value), format.decimals);
  if (!format.trailing_zeros) {
    while (text.back() == '0') text.pop_back();  // up to the point
  }
  if (text.back() == '.' && !format.always_point) text.pop_back();
  const bool is_zero = text.find_first_of("123456789") == std::string::npos;
  if (value < 0 && !is_zero) out += '-';
  out += text;
}

std::string to_text(double value, const NumberFormat& format) {
  std::string text;
  append_number(text, value, format);
  return text;
}

double rounded(double value, int decimals) {
  const std::string text = to_text(value, NumberFormat{.decimals = decimals});
  return scan_number(text)->number.value;
}

std::optional<ScannedNumber> scan_number(std::string_view text) {
  std::size_t at = after_blanks(text, 0);
  const bool negative = char_at(text, at) == '-';
  if (negative || char_at(text, at) == '+') ++at;
  ScannedNumber found;
  auto& [value, decimals, has_point] = found.number;
  std::string digits;  // with the point, without blanks
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (is_blank(c)) continue;
    if (!is_digit(c) && (c != '.' || has_point)) break;
    decimals += has_point ? 1 : 0;
    has_point = has_point || c == '.';
    digits += c;
    found.length = at + 1;
  }
  if (digits.empty() || digits == ".") return std::nullopt;
  const auto read = std::from_chars(digits.data(), digits.data() + digits.size(), value,
                                    std::chars_format::fixed);
  // Out of range: too great for a double, or smaller than any where nothing but zeros is before the
  // point.
  if (read.ec != std::errc{} && digits.find_first_of("123456789") < digits.find('.')) {
    return std::nullopt;
  }
  if (negative && value != 0) value = -value;
  return found;
}

std::optional<ReadNumber> read_number(std::string_view text) {
  const std::optional<ScannedNumber> scanned = scan_number(text);
  if (!scanned || after_blanks(text, scanned->length) < text.size()) return std::nullopt;
  return scanned->number;
}

}  // namespace batten::gcode
