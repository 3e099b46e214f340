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

// A double has at most 17 significant digits in its shortest decimal.
constexpr std::size_t kMostDigits = 17;

// The decimal d0.d1d2.. times ten to the exponent.
struct Decimal {
  std::array<char, kMostDigits> digits{};
  int count = 0;
  int exponent = 0;
  bool negative = false;

  [[nodiscard]] char digit(int index) const {
    return index >= 0 && index < count ? digits[static_cast<std::size_t>(index)] : '0';
  }
};

// The shortest decimal that stands for this double and no other.
Decimal shortest_decimal(double value) {
  std::array<char, 32> text{};  // sign, 17 digits, point, e-308
  const auto written =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific);
  Decimal decimal;
  const char* at = text.data();
  if (*at == '-') {
    decimal.negative = true;
    ++at;
  }
  for (; at != written.ptr && *at != 'e'; ++at) {
    if (*at != '.') {
      decimal.digits[static_cast<std::size_t>(decimal.count++)] = *at;
    }
  }
  ++at;              // the e
  if (*at == '+') {  // from_chars takes no plus
    ++at;
  }
  std::from_chars(at, written.ptr, decimal.exponent);
  return decimal;
}

// Adds one to the last of the first `keep` digits.
void carry(Decimal& decimal, int keep) {
  int index = keep - 1;
  for (; index >= 0; --index) {
    char& digit = decimal.digits[static_cast<std::size_t>(index)];
    if (digit != '9') {
      ++digit;
      return;
    }
    digit = '0';
  }
  // All nines (or no digit was kept): the number is the next power of ten.
  decimal.digits[0] = '1';
  decimal.count = 1;
  ++decimal.exponent;
}

// Half away from zero, to so many digits after the point.
void round_to(Decimal& decimal, int decimals) {
  const int keep = decimal.exponent + 1 + decimals;
  if (keep >= decimal.count) {
    return;
  }
  const bool up = decimal.digit(keep) >= '5';
  decimal.count = keep > 0 ? keep : 0;
  if (up) {
    carry(decimal, keep);
  }
}

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

bool is_zero(const Decimal& decimal) {
  for (int i = 0; i < decimal.count; ++i) {
    if (decimal.digit(i) != '0') {
      return false;
    }
  }
  return true;
}

// How many digits after the point are written: all that are asked for, or up to the last
// that is not zero.
int fraction_digits(const Decimal& decimal, const NumberFormat& format) {
  if (format.trailing_zeros) {
    return format.decimals;
  }
  int last = format.decimals;
  while (last > 0 && decimal.digit(decimal.exponent + last) == '0') {
    --last;
  }
  return last;
}

// Ten to the power of 0 .. 22: exact as doubles, so one division rounds once, correctly.
constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                 1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

// The size of a number in steps of its last decimal, where it is plain: not great, and not so near
// to the middle of two steps that the double and its shortest decimal might be rounded apart.
std::optional<std::uint32_t> plain_steps(double value, int decimals) {
  constexpr double kMostSteps = 1e9;  // of which a double and its decimal hold 1e-7
  constexpr double kNearMiddle = 1e-5;
  const double steps = std::abs(value) * kPowersOfTen[static_cast<std::size_t>(decimals)];
  if (!(steps < kMostSteps)) return std::nullopt;
  const auto below = static_cast<std::uint32_t>(steps);
  const double part = steps - below;
  if (std::abs(part - 0.5) < kNearMiddle) return std::nullopt;
  return part > 0.5 ? below + 1 : below;
}

void append_steps(std::string& out, bool negative, std::uint32_t steps,
                  const NumberFormat& format) {
  std::array<char, 16> text{};
  auto at = text.end();
  int fraction = format.decimals;
  bool said = format.trailing_zeros;
  for (; fraction > 0; --fraction, steps /= 10) {
    const auto digit = static_cast<char>(steps % 10);
    said = said || digit != 0;
    if (said) *--at = static_cast<char>('0' + digit);
  }
  if (at != text.end() || format.always_point) *--at = '.';
  do {
    *--at = static_cast<char>('0' + steps % 10);
    steps /= 10;
  } while (steps > 0);
  if (negative) *--at = '-';
  out.append(at, text.end());
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

// Fifteen digits are below 2^53, below which every integer is a double.
constexpr int kExactDigits = 15;

// The way of nearly all numbers: few digits and no blanks between them. False when the number
// is of another kind; `scan` is of no use then.
bool scan_plain_digits(std::string_view text, std::size_t at, Scan& scan) {
  std::uint64_t mantissa = 0;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) {
    mantissa = mantissa * 10 + static_cast<std::uint64_t>(text[at++] - '0');
  }
  std::size_t digits = at - begin;
  if (at < text.size() && text[at] == '.') {
    scan.has_point = true;
    const std::size_t fraction = ++at;
    while (at < text.size() && is_digit(text[at])) {
      mantissa = mantissa * 10 + static_cast<std::uint64_t>(text[at++] - '0');
    }
    scan.decimals = static_cast<int>(at - fraction);
    digits += at - fraction;
  }
  scan.mantissa = mantissa;
  scan.digits = static_cast<int>(digits);
  scan.end = at;
  std::size_t following = at;
  while (following < text.size() && is_blank(text[following])) {
    ++following;
  }
  // Behind blanks the same number may go on.
  const bool goes_on = following > at && following < text.size() &&
                       (is_digit(text[following]) || text[following] == '.');
  return digits > 0 && digits <= kExactDigits && !goes_on;
}

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
  std::string plain;
  plain.reserve(digits.size());
  for (const char c : digits) {
    if (!is_blank(c)) {
      plain.push_back(c);
    }
  }
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
  if (const auto steps = plain_steps(value, format.decimals)) {
    append_steps(out, value < 0 && *steps > 0, *steps, format);
    return;
  }
  Decimal decimal = shortest_decimal(value);
  round_to(decimal, format.decimals);
  if (is_zero(decimal)) {
    decimal = Decimal{};
  }
  if (decimal.negative) {
    out.push_back('-');
  }
  if (decimal.exponent < 0) {
    out.push_back('0');
  }
  for (int i = 0; i <= decimal.exponent; ++i) {
    out.push_back(decimal.digit(i));
  }
  const int fraction = fraction_digits(decimal, format);
  if (fraction > 0 || format.always_point) {
    out.push_back('.');
  }
  for (int i = 1; i <= fraction; ++i) {
    out.push_back(decimal.digit(decimal.exponent + i));
  }
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
  std::size_t at = 0;
  while (at < text.size() && is_blank(text[at])) {
    ++at;
  }
  const bool negative = at < text.size() && text[at] == '-';
  if (negative || (at < text.size() && text[at] == '+')) {
    ++at;
  }
  Scan scan;
  if (!scan_plain_digits(text, at, scan)) {
    scan = scan_digits(text, at);
  }
  if (scan.digits == 0) {
    return std::nullopt;
  }
  const std::optional<double> magnitude = value_of(scan, text.substr(at, scan.end - at));
  if (!magnitude) {
    return std::nullopt;
  }
  // -0 is read as 0, so that equal places compare equal bit by bit.
  const double value = negative && *magnitude != 0 ? -*magnitude : *magnitude;
  return ScannedNumber{{value, scan.decimals, scan.has_point}, scan.end};
}

std::optional<ReadNumber> read_number(std::string_view text) {
  const std::optional<ScannedNumber> scanned = scan_number(text);
  if (!scanned) {
    return std::nullopt;
  }
  for (const char c : text.substr(scanned->length)) {
    if (!is_blank(c)) {
      return std::nullopt;
    }
  }
  return scanned->number;
}

}  // namespace batten::gcode
