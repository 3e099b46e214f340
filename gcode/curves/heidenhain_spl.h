// Heidenhain SPL blocks (TNC 426, TNC 430, iTNC 530): one cubic polynomial per axis and block, in t
// from 1 to 0. Facts and sources: docs/controllers/heidenhain_curves.md.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// --- Klartext lines, as far as splines and lines need them ---------------------------------------
// `8 SPL X+24.875 Y+15.924 ~`, `K3X-4.688E-002`, `F10000`, `FMAX`, `M3`.

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

// --- splines ------------------------------------------------------------------------------------

// The control stops where the start that K1, K2, K3 and the end imply is further from the place
// where the tool stands, on any axis (mm).
inline constexpr double kSplClosure = 1e-3;

// It stops, or slows down, where one spline meets the next under this angle or more (radians).
inline constexpr double kSplKink = 0.1 * std::numbers::pi / 180;

// K as it is printed: `+5.6`, `-1.2E+001`. Nothing beyond the range of the control.
struct PrintedCoefficient {
  std::string digits;
  double value = 0;  // as read
};
[[nodiscard]] std::optional<PrintedCoefficient> print_spl_coefficient(double value, int decimals);

// The words of one SPL block, whose lines are joined, before what they say is judged.

inline constexpr std::string_view kSplAxes = "XYZUVWABC";

[[nodiscard]] bool is_spl_coefficient(const KlartextWord& word);  // K1X ..
[[nodiscard]] bool is_spl_end(const KlartextWord& word);          // X with a value ..

// The lines of one block, joined.
struct SplWords {
  std::vector<KlartextWord> words;
  std::uint32_t lines = 0;
  bool understood = true;

  [[nodiscard]] bool is(std::string_view keyword) const {
    return !words.empty() && words.front().is(keyword);
  }
};

// The block that begins in line `first`, whether it is an SPL or not.
[[nodiscard]] SplWords joined_at(const Program& program, std::uint32_t first);

// What is wrong with the words of a spline, as the id of an alarm; empty where nothing is.
[[nodiscard]] std::string_view spl_word_trouble(const SplWords& block);

// What one block says.
struct SplBlock {
  std::array<bool, 3> axes = {false, false, false};
  std::optional<double> feed;   // as printed
  geometry::CubicBezier piece;  // from its own start, at t = 1
};

// What the block says where the tool stands at `place` (mm). Requires words without trouble.
[[nodiscard]] SplBlock spl_block_of(const SplWords& joined, const geometry::Point3& place,
                                    double unit);

// SPL as a format: for the controls that read it as an option.
//
// What is written: a block per piece, and per block a line with the end and a line for each axis,
// all but the last with ~. K1 is chosen so that the printed numbers of a block add up to its start:
// the error of rounding is in the tangent, and far below the angle at which the control stops. K
// has the decimals of `setting.other`, more where a joint would have a kink. Refused are a curve
// that starts further than one step of the printed places from the tool, fewer than two named axes,
// numbers beyond the control's ranges, blocks that would not close to within 1 um, and kinks of 0.1
// degrees or more that the given pieces do not have.
//
// What is read: the SPL blocks from line `first` on, up to the first line that is none, or that has
// an F of its own. Lines are joined by ~, and where a line starts with a K word. Refused are
// splines of other axes, other words, K words that are missing or in another order, an axis whose
// place is not known, and a start that is further from the tool than 1 um.
[[nodiscard]] const CurveFormat& heidenhain_spl();

// What the numbers of an SPL block may be (iTNC 530 manual, 60642x-04, p. 541).

inline constexpr double kGreatestMantissa = 9.99999999;  // of a coefficient
inline constexpr int kMantissaDecimals = 8;
inline constexpr double kGreatestEnd = 99999.9999;  // of an end point, mm

}  // namespace batten::gcode
