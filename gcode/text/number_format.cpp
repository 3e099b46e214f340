#include "gcode/text/number_format.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
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

// The shortest decimal that stands for this double and no other, with so many digits behind the
// point: half goes away from zero.
std::string rounded_decimal(double size, int decimals) {
  std::array<char, 400> shortest{};  // the least double has 324 digits behind the point
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

// Digits and point of a number.
struct Scan {
  std::uint64_t mantissa = 0;  // of all digits, while it is exact
  int digits = 0;
  int decimals = 0;
  bool exact = true;  // mantissa still holds every digit
  bool has_point = false;
  bool whole_part = false;  // a digit other than 0 stands before the point
  std::size_t end = 0;      // after the last character of the number
};

Scan scan_digits(std::string_view text, std::size_t at) {
  // A mantissa below this takes one digit more without leaving 2^53, below which every
  // integer is a double.
  constexpr std::uint64_t kOneMoreDigit = 900'000'000'000'000;
  Scan scan;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (is_digit(c)) {
      if (scan.mantissa < kOneMoreDigit) {
        scan.mantissa = scan.mantissa * 10 + static_cast<std::uint64_t>(c - '0');
      } else {
        scan.exact = false;
      }
      ++scan.digits;
      scan.decimals += scan.has_point ? 1 : 0;
      scan.whole_part = scan.whole_part || (!scan.has_point && c != '0');
    } else if (c == '.' && !scan.has_point) {
      scan.has_point = true;
    } else if (is_blank(c)) {
      continue;
    } else {
      break;
    }
    scan.end = at + 1;
  }
  return scan;
}

// The value of more digits than a double holds. Nothing when it is too great for a double.
std::optional<double> value_of_many_digits(std::string_view digits, bool whole_part) {
  const std::string plain = without_blanks(digits);
  double value = 0;
  const auto result =
      std::from_chars(plain.data(), plain.data() + plain.size(), value, std::chars_format::fixed);
  if (result.ec == std::errc{}) {
    return value;
  }
  // Out of range: smaller than any double when nothing stands before the point.
  return whole_part ? std::nullopt : std::optional<double>(0.0);
}

std::optional<double> value_of(const Scan& scan, std::string_view digits) {
  if (scan.exact && static_cast<std::size_t>(scan.decimals) < kPowersOfTen.size()) {
    return static_cast<double>(scan.mantissa) /
           kPowersOfTen[static_cast<std::size_t>(scan.decimals)];
  }
  return value_of_many_digits(digits, scan.whole_part);
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
  ReadNumber plain;
  if (const char* const behind =
          read_plain_number(text.data() + at, text.data() + text.size(), plain)) {
    // Behind blanks the same number may go on.
    const auto length = static_cast<std::size_t>(behind - text.data());
    const char next = char_at(text, after_blanks(text, length));
    if (!is_digit(next) && next != '.') return ScannedNumber{plain, length};
  }
  const bool negative = char_at(text, at) == '-';
  if (negative || char_at(text, at) == '+') ++at;
  const Scan scan = scan_digits(text, at);
  if (scan.digits == 0) return std::nullopt;
  const std::optional<double> magnitude = value_of(scan, text.substr(at, scan.end - at));
  if (!magnitude) return std::nullopt;
  const double value = negative && *magnitude != 0 ? -*magnitude : *magnitude;
  return ScannedNumber{{value, scan.decimals, scan.has_point}, scan.end};
}

std::optional<ReadNumber> read_number(std::string_view text) {
  const std::optional<ScannedNumber> scanned = scan_number(text);
  if (!scanned || after_blanks(text, scanned->length) < text.size()) return std::nullopt;
  return scanned->number;
}

}  // namespace batten::gcode
