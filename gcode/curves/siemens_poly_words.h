// The words of one block of polynomials, and the polynomials that they say.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "gcode/curves/siemens_words.h"

namespace batten::gcode {

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

// a0, a1, a2 .. of the polynomial that is `first` at 0 and `last` at `length`, where `given` is the
// end as printed and a2, a3 .. behind it.
[[nodiscard]] std::vector<double> polynomial_of(double first, double last,
                                                const std::vector<double>& given, double unit,
                                                double length);

// Whether a denominator is above 0 on [0, length].
[[nodiscard]] bool is_positive_until(const std::vector<double>& a, double length);

}  // namespace batten::gcode
