// The words of a Siemens block, as far as polynomials and splines need them: `X10`, `X=10`,
// `PL=0.5`, `PO[X]=(18,-18,6)`, `POLY`, `G1`.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace batten::gcode {

struct SiemensWord {
  std::string name;            // upper case, without blanks: "X", "PO[X]", "PO[]", "POLY"
  std::vector<double> values;  // one, those in parentheses, or none
  int decimals = 0;            // the most that one of the values has

  [[nodiscard]] bool is(std::string_view other) const { return name == other; }
  [[nodiscard]] double value() const { return values.front(); }  // requires one
};

// Comments (; to the end) are left out. Nothing where the block has anything else than such words:
// expressions, strings, AC(..), exponents, labels.
[[nodiscard]] std::optional<std::vector<SiemensWord>> read_siemens_words(std::string_view block);

}  // namespace batten::gcode
