// The curves of Siemens controls, POLY and BSPLINE. Facts and sources:
// docs/controllers/siemens_curves.md.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/curves/curve_format.h"

namespace batten::gcode {

// POLY: one polynomial per axis and block. One block per piece is written, POLY in the first, PL
// left out (1). The end is printed as `setting.places` says, the two coefficients with
// `setting.other`; the linear one is not printed: the control computes it from the ends, so each
// block starts exactly where the one before ended. The printed piece has the tangents of the given
// one at both ends: rounded ends make no kinks.
//
// What is read: block `first` has POLY; what follows belongs to it as long as it consists of PO, PL
// and axis words: those without PO are straight, as the control runs them. G90 may stand beside
// POLY. Refused are rational polynomials and those above the third degree, coefficients for an axis
// whose place is not known, and PL outside 0.0001 to 99999.9999.
[[nodiscard]] const CurveFormat& siemens_poly();

// BSPLINE: the control points of a B-spline. Only under --output curves, and for who names the
// target that has them: what the control makes of the blocks is not verified, and the caution says
// so. What is read has the same assumptions as what is written.
[[nodiscard]] const CurveFormat& siemens_bspline();

// --- words --------------------------------------------------------------------------------------

// A word of a Siemens block, as far as polynomials and splines need it: `X10`, `X=10`, `PL=0.5`,
// `PO[X]=(18,-18,6)`, `POLY`, `G1`.
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

// The words of one block of polynomials.

// Characters of one block.
inline constexpr std::size_t kSiemensLine = 512;

// PL is in this range.
inline constexpr double kShortestPoly = 0.0001;
inline constexpr double kLongestPoly = 99999.9999;

// One block's words, sorted.
struct PolyWords {
  bool poly = false;
  bool understood = true;  // nothing else stands in the block
  std::array<const SiemensWord*, 3> polynomial{};
  std::array<const SiemensWord*, 3> straight{};
  const SiemensWord* denominator = nullptr;
  std::optional<double> length;
  std::optional<double> feed;

  [[nodiscard]] bool any_polynomial() const {
    return polynomial[0] != nullptr || polynomial[1] != nullptr || polynomial[2] != nullptr ||
           denominator != nullptr;
  }
  [[nodiscard]] bool moves() const {
    return any_polynomial() || straight[0] != nullptr || straight[1] != nullptr ||
           straight[2] != nullptr;
  }
};

// Points into `words`. Without words, or with others: not understood.
[[nodiscard]] PolyWords poly_words_of(const std::optional<std::vector<SiemensWord>>& words);

}  // namespace batten::gcode
