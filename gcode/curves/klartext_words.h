// The words of a Heidenhain Klartext line, as far as splines and lines need them:
// `8 SPL X+24.875 Y+15.924 ~`, `K3X-4.688E-002`, `F10000`, `FMAX`, `M3`.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace batten::gcode {

// The control refuses an arc whose ends are not on one circle about CC, by more than this (mm; a
// machine parameter, from memory).
inline constexpr double kKlartextRadiusMismatch = 0.016;

struct KlartextWord {
  std::string name;  // upper case: "X", "K3X", "SPL", "FMAX", "RL", "DR+"
  std::optional<double> value;
  double mantissa = 0;  // the digits before an exponent; `value` without one
  int decimals = 0;     // of the mantissa
  std::optional<int> exponent;

  [[nodiscard]] bool is(std::string_view other) const { return name == other; }
};

struct KlartextLine {
  std::optional<int> number;  // of the block
  std::vector<KlartextWord> words;
  bool continues = false;  // ends with ~
};

// Comments (; to the end) are left out; a decimal comma is read as a point. Nothing where the line
// has anything else than such words.
[[nodiscard]] std::optional<KlartextLine> read_klartext_line(std::string_view line);

}  // namespace batten::gcode
