// The curve words of one control, as its control gives them (Control::curves). The text itself is
// made and read by the pure functions beside this file.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/text/number_format.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// How a curve is printed. What a format prints beside places (knots, weights, coefficients) has
// decimals of its own, in `other`.
struct CurveSetting {
  Units units = Units::kMillimetre;
  NumberFormat places;  // control points and ends of pieces
  NumberFormat other;   // knots; coefficients of polynomials; offsets of Bezier points
  NumberFormat feeds;
  int last_decimals = 0;  // the curve's last place may have so many, where they are more
  // The axes that are named, all of them in each block that names any. The curve does not move
  // the others.
  std::array<bool, 3> axes = {true, true, true};
  // Where the tool stands (mm), as the control knows it. The curve's first point is this place but
  // for what rounding moved; what is written starts here exactly.
  geometry::Point3 start = geometry::Point3::Zero();
  std::optional<double> feed;  // mm/min, said in the first block; nothing: it is set already
  bool blanks = true;          // between words
};

// Why a curve cannot be written or read, for people; no full stop.
struct CurveRefusal {
  std::string why;
};

// Whole blocks without line ends, in order. Nothing stands between them in the program.
using CurveLines = std::vector<std::string>;
using CurveWriting = std::variant<CurveLines, CurveRefusal>;

// Where a curve that is read begins.
struct CurveStart {
  Position position;  // mm, before the first block
  Units units = Units::kMillimetre;
};

// A piece of the curve, by the printed numbers.
struct CurveMotion {
  std::uint32_t block = 0;  // index into Program::blocks; each block has one piece at the most
  geometry::PathPiece piece;
};

struct CurveReading {
  std::uint32_t blocks = 0;          // how many blocks say the curve, from the first on
  std::vector<CurveMotion> motions;  // in order, `block` increasing; they chain
  std::array<bool, 3> axes = {false, false, false};  // named by its blocks
  std::optional<double> feed;  // F of the first block, in the program's units per minute
};

// A refusal where the blocks are no curve, or one that is not read exactly: a weight that is not 1,
// other words between, a start that is not where the tool stands, the program ends inside it.
using CurveResult = std::variant<CurveReading, CurveRefusal>;

class CurveFormat {
 public:
  virtual ~CurveFormat() = default;

  [[nodiscard]] virtual std::string_view name() const = 0;  // "G06.2"

  // Whether curves are tried under --output auto: the control reads them without an option that
  // the user has to own, and runs them as they are meant.
  [[nodiscard]] virtual bool is_default() const = 0;

  // What a user has to be told when such curves were written, since it is not verified; empty where
  // there is nothing.
  [[nodiscard]] virtual std::string_view caution() const { return {}; }

  // Why no curve may start in this state (cutter compensation, feed mode, plane ..); empty where it
  // may. Units, absolute distances and feed per minute are known already.
  [[nodiscard]] virtual std::string_view complaint(const ModalState& state) const = 0;

  // Whether the control runs this piece of a curve. What it does not is written as lines.
  [[nodiscard]] virtual bool takes(const geometry::CubicBezier&) const { return true; }

  // Whether the control runs curves as chords of its own that count. They leave a piece by
  // chords_error (mm) at the most.
  [[nodiscard]] virtual bool is_run_as_chords() const { return false; }
  [[nodiscard]] virtual double chords_error(const geometry::CubicBezier&) const { return 0; }

  // Whether every piece is a block for itself. Otherwise a curve has blocks beside those of its
  // pieces, and short curves are not worth them.
  [[nodiscard]] virtual bool is_block_per_piece() const = 0;

  // Whether the control wants X, Y and Z in every curve, moved or not.
  [[nodiscard]] virtual bool names_all_axes() const { return false; }

  // How knots, coefficients or offsets are printed.
  [[nodiscard]] virtual NumberFormat other_numbers(Units units) const = 0;

  [[nodiscard]] virtual CurveWriting write(const geometry::BsplineCurve& curve,
                                           const CurveSetting& setting) const = 0;

  // The curve whose first block is block `first`. Quick where that block starts none.
  [[nodiscard]] virtual CurveResult read(const Program& program, std::uint32_t first,
                                         const CurveStart& start) const = 0;
};

// What the curve blocks of most controls can hold.

// A cubic that starts and ends in its outer control points.
[[nodiscard]] inline bool is_clamped_cubic(const geometry::BsplineCurve& curve) {
  constexpr std::size_t kOrder = 4;
  const auto& t = curve.basis().knots();
  return curve.degree() == 3 && t[0] == t[kOrder - 1] && t[t.size() - kOrder] == t.back();
}

}  // namespace batten::gcode
