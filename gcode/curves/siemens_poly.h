// Siemens POLY blocks: one polynomial per axis and block. Facts and sources:
// docs/controllers/siemens_curves.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "gcode/curves/siemens_words.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// Why a POLY may not start in this state; empty where it may.
[[nodiscard]] std::string_view poly_complaint(const ModalState& state);

// One block per piece, POLY in the first, PL left out (1). The end is printed as `setting.places`
// says, the two coefficients with `setting.other`; the linear one is not printed: the control
// computes it from the ends, so each block starts exactly where the one before ended. The printed
// piece has the tangents of the given one at both ends: rounded ends make no kinks.
//
// Refuses an empty chain, a chain that does not start where the tool stands (to within one step of
// the printed places), lines above 512 characters.
[[nodiscard]] CurveWriting write_poly(std::span<const geometry::CubicBezier> pieces,
                                      const CurveSetting& setting);

// What one block says: for each axis a polynomial in p from 0 to `length`, over one denominator.
struct PolyBlock {
  std::uint32_t block = 0;                       // index into Program::blocks
  std::array<std::vector<double>, 3> numerator;  // a0, a1, ..; mm
  std::vector<double> denominator = {1};
  double length = 1;  // PL
  geometry::Point3 start = geometry::Point3::Zero();
  geometry::Point3 end = geometry::Point3::Zero();  // mm
  std::array<bool, 3> axes = {false, false, false};

  [[nodiscard]] geometry::Point3 point_at(double p) const;
  // A line, or a Bezier piece; nothing for rational ones and for a degree above three.
  [[nodiscard]] std::optional<geometry::PathPiece> piece() const;
};

struct PolyText {
  std::vector<PolyBlock> pieces;  // blocks that move nothing have none
  std::uint32_t blocks = 0;
  std::optional<double> feed;  // as printed, in the first block
};

// Block `first` has POLY; what follows belongs to it as long as it consists of PO, PL and axis
// words: those without PO are straight, as the control runs them. G90 may stand beside POLY.
// Degrees up to five and denominators are read. Refuses coefficients for an axis whose place is not
// known, PL outside 0.0001 to 99999.9999, and a denominator that is 0 in its interval.
[[nodiscard]] std::variant<PolyText, CurveRefusal> read_poly_text(const Program& program,
                                                                  std::uint32_t first,
                                                                  const CurveStart& start);

// The same as pieces of a path; refuses those that are no line and no cubic polynomial.
[[nodiscard]] CurveResult read_poly(const Program& program, std::uint32_t first,
                                    const CurveStart& start);

// Characters of one block.
inline constexpr std::size_t kSiemensLine = 512;

// The words of one block of polynomials, and the polynomials that they say.

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

// POLY as the curves of Siemens controls; see gcode/curves/siemens_poly.h.

[[nodiscard]] const CurveFormat& siemens_poly();

}  // namespace batten::gcode
