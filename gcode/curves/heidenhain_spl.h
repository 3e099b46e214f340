// Heidenhain SPL blocks (TNC 426, TNC 430, iTNC 530): one cubic polynomial per axis and block, in t
// from 1 to 0. Facts and sources: docs/controllers/heidenhain_curves.md.
#pragma once

#include <array>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "gcode/curves/curve_format.h"
#include "gcode/curves/klartext_words.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// The control stops where the start that K1, K2, K3 and the end imply is further from the place
// where the tool stands, on any axis (mm).
inline constexpr double kSplClosure = 1e-3;

// It stops, or slows down, where one spline meets the next under this angle or more (radians).
inline constexpr double kSplKink = 0.1 * std::numbers::pi / 180;

// Why a spline may not start in this state; empty where it may.
[[nodiscard]] std::string_view spl_complaint(const ModalState& state);

struct SplOptions {
  // Decimals of K: at the least those of `setting.other`, more where a joint would have a kink.
  int max_decimals = 8;
  // The number of the first block, the others follow; nothing: no numbers are written.
  std::optional<int> first_number;
};

// A block per piece, and per block a line with the end and a line for each axis, all but the last
// with ~. K1 is chosen so that the printed numbers of a block add up to its start: the error of
// rounding is in the tangent, and far below the angle at which the control stops.
//
// Refuses an empty chain, one that starts further than one step of the printed places from the
// tool, fewer than two named axes, numbers beyond the control's ranges, blocks that would not
// close to within 1 um, and kinks of 0.1 degrees or more that the given pieces do not have.
[[nodiscard]] CurveWriting write_spl(std::span<const geometry::CubicBezier> pieces,
                                     const CurveSetting& setting, const SplOptions& options);

// K as it is printed: `+5.6`, `-1.2E+001`. Nothing beyond the range of the control.
struct PrintedCoefficient {
  std::string digits;
  double value = 0;  // as read
};
[[nodiscard]] std::optional<PrintedCoefficient> print_spl_coefficient(double value, int decimals);

// What one block says.
struct SplBlock {
  std::uint32_t block = 0;  // of its first line
  std::array<bool, 3> axes = {false, false, false};
  geometry::Point3 end = geometry::Point3::Zero();                  // mm
  std::array<geometry::Vector3, 3> k = {geometry::Vector3::Zero(),  // K1, K2, K3; mm
                                        geometry::Vector3::Zero(), geometry::Vector3::Zero()};
  std::optional<double> feed;  // as printed

  [[nodiscard]] geometry::Point3 point_at(double t) const;  // t from 1 to 0
  [[nodiscard]] geometry::CubicBezier piece() const;        // from its own start, at t = 1
};

struct SplText {
  std::vector<SplBlock> pieces;
  std::uint32_t blocks = 0;  // lines of the program
};

// Reads the SPL blocks from line `first` on, up to the first line that is none, or that has an F of
// its own. Lines are joined by ~, and where a line starts with a K word. Refuses splines of other
// axes, other words, K words that are missing or in another order, an axis whose place is not
// known, and a start that is further from the tool than 1 um.
[[nodiscard]] std::variant<SplText, CurveRefusal> read_spl_text(const Program& program,
                                                                std::uint32_t first,
                                                                const CurveStart& start);

// The same as pieces. They start where their K words say, so they chain to within 1 um, and to the
// rounding of doubles where Batten wrote them.
[[nodiscard]] CurveResult read_spl(const Program& program, std::uint32_t first,
                                   const CurveStart& start);

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

// What the block says that begins in line `at`, where the tool stands at `place` (mm). Requires
// words without trouble.
[[nodiscard]] SplBlock spl_block_of(const SplWords& joined, std::uint32_t at,
                                    const geometry::Point3& place, double unit);

// Heidenhain SPL as a CurveFormat: for the controls that read it as an option.

[[nodiscard]] const CurveFormat& heidenhain_spl();

// What the numbers of an SPL block may be (iTNC 530 manual, 60642x-04, p. 541).

inline constexpr double kGreatestMantissa = 9.99999999;  // of a coefficient
inline constexpr int kMantissaDecimals = 8;
inline constexpr double kGreatestEnd = 99999.9999;  // of an end point, mm

}  // namespace batten::gcode
