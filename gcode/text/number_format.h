// Numbers as controls read them: plain decimals, no exponent, no "-0".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/text/characters.h"

namespace batten::gcode {

struct NumberFormat {
  int decimals = 4;             // digits after the point at the most; 0..9
  bool trailing_zeros = false;  // X1.5000 or X1.5
  bool always_point = false;    // X5. rather than X5
};

// Rounded to format.decimals, half away from zero on the shortest decimal that the double
// stands for; never "-0", never an exponent. Requires |value| < 1e9.
void append_number(std::string& out, double value, const NumberFormat& format);
[[nodiscard]] std::string to_text(double value, const NumberFormat& format);

// The number that a control reads from what `append_number` wrote.
[[nodiscard]] double rounded(double value, int decimals);

// A G-code number: optional sign (+ too), digits, optional point; no exponent; at least one
// digit. Nothing when `text` is anything else. Blanks inside are skipped, as RS-274 says.
struct ReadNumber {
  double value = 0;
  int decimals = 0;
  bool has_point = false;
};
[[nodiscard]] std::optional<ReadNumber> read_number(std::string_view text);

// The number at the start of `text`, as far as it goes, and how many bytes it takes (blanks
// after its last character are not its own). Nothing when `text` does not start with one, or
// when it is greater than a double can be.
struct ScannedNumber {
  ReadNumber number;
  std::size_t length = 0;
};
[[nodiscard]] std::optional<ScannedNumber> scan_number(std::string_view text);

// No control takes numbers as great as this, and none that we write is.
inline constexpr double kNumberLimit = 1e9;

// Ten to the power of 0 .. 22: exact as doubles, so one division rounds once, correctly.
inline constexpr std::array<double, 23> kPowersOfTen = {
    1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// Fifteen digits are below 2^53, below which every integer is a double.
inline constexpr std::size_t kExactDigits = 15;

// After the digits there. The mantissa is of no use where they are too many.
inline const char* behind_digits(const char* at, const char* end, std::uint64_t& mantissa) {
  for (; at != end && is_digit(*at); ++at) {
    mantissa = mantissa * 10 + static_cast<std::uint64_t>(*at - '0');
  }
  return at;
}

// Fast path for nearly all numbers: a sign, at most fifteen digits without blanks, a point; below
// kNumberLimit. Gives the position after it; nullptr, and `number` is of no use, for others.
[[nodiscard]] inline const char* read_plain_number(const char* at, const char* end,
                                                   ReadNumber& number) {
  const bool negative = at != end && *at == '-';
  if (negative || (at != end && *at == '+')) ++at;
  std::uint64_t mantissa = 0;
  const char* behind = behind_digits(at, end, mantissa);
  auto digits = static_cast<std::size_t>(behind - at);
  number.decimals = 0;
  number.has_point = behind != end && *behind == '.';
  if (number.has_point) {
    const char* const fraction = behind + 1;
    behind = behind_digits(fraction, end, mantissa);
    number.decimals = static_cast<int>(behind - fraction);
    digits += static_cast<std::size_t>(number.decimals);
  }
  if (digits == 0 || digits > kExactDigits) return nullptr;
  const double size =
      static_cast<double>(mantissa) / kPowersOfTen[static_cast<std::size_t>(number.decimals)];
  number.value = negative && mantissa != 0 ? -size : size;  // -0 is read as 0
  return size < kNumberLimit ? behind : nullptr;
}

}  // namespace batten::gcode
