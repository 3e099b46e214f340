// Numbers as controls read them: plain decimals, no exponent, no "-0".
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

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

// The way of nearly all numbers: a sign, at most fifteen digits without blanks, a point; below
// kNumberLimit. Gives the place behind it; nullptr, and `number` is of no use, for others.
[[nodiscard]] const char* read_plain_number(const char* at, const char* end, ReadNumber& number);

// No control takes numbers as great as this, and none that we write is.
inline constexpr double kNumberLimit = 1e9;

}  // namespace batten::gcode
