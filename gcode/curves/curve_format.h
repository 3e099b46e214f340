// The curve words of one control (Control::curves), and curves in the midst of a program.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "gcode/state/block_flow.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/motion.h"
#include "gcode/text/number_format.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// How a curve is printed.
struct CurveSetting {
  Units units = Units::kMillimetre;
  NumberFormat places;  // control points and ends of pieces
  NumberFormat other;   // knots; coefficients of polynomials; offsets of Bezier points
  NumberFormat feeds;
  int last_decimals = 0;  // the curve's last place may have so many, where they are more
  // The axes that are named, all of them in each block that names any. The curve does not move
  // the others.
  std::array<bool, 3> axes = {true, true, true};
  // The tool's position (mm) as the control knows it: the curve's first point but for what rounding
  // moved. What is written starts here exactly.
  geometry::Point3 start = geometry::Point3::Zero();
  std::optional<double> feed;  // mm/min, said in the first block; nothing: it is set already
  bool blanks = true;          // between words
};

// Why a curve cannot be written or read, for people; no full stop.
struct CurveRefusal {
  std::string why;
};

// Whole blocks without line ends, in order, with nothing between them.
using CurveLines = std::vector<std::string>;
using CurveWriting = std::variant<CurveLines, CurveRefusal>;

// Where a curve that is read begins.
struct CurveStart {
  Position position;  // mm, before the first block
  Units units = Units::kMillimetre;
};

// A piece of the curve, by the printed numbers.
struct CurveMotion {
  std::uint32_t block = 0;  // index into Program::blocks
  geometry::PathPiece piece;
  // Into which LinuxCNC cuts it, below 1 where several pieces are one; 0: not known.
  float arcs = 0;
};

struct CurveReading {
  std::uint32_t blocks = 0;          // how many blocks say the curve, from the first on
  std::vector<CurveMotion> motions;  // in order, `block` never less; they chain
  bool is_near = false;              // the pieces are within kReadWithin of the curve, not exact
  std::array<bool, 3> axes = {false, false, false};  // named by its blocks
  int decimals = 0;            // most digits after the point of the places that its blocks name
  std::optional<double> feed;  // F of the first block, in the program's units per minute
};

// A refusal where the blocks are no curve, or one that is not read: a weight that is not positive,
// other words between, a start that is not the tool's position, the program ends inside it.
using CurveResult = std::variant<CurveReading, CurveRefusal>;

// A format as a value: what differs between the curves of controls, and the functions that write
// and read them.
struct CurveFormat {
  std::string_view name;  // "G06.2"
  std::string_view caution = {};  // for who gets such curves: what is not verified; empty: nothing
  // Whether every piece is a block for itself. Otherwise a curve has blocks beside those of its
  // pieces, and short curves are not worth them.
  bool is_block_per_piece = true;
  bool names_all_axes = false;  // X, Y and Z in every curve, moved or not
  bool only_in_xy = false;      // under G17
  NumberFormat other_mm;        // of knots, coefficients or offsets
  NumberFormat other_inch;

  std::function<CurveWriting(const geometry::BsplineCurve&, const CurveSetting&)> write;

  // The curve whose first block is block `first`. Quick where that block starts none.
  std::function<CurveResult(const Program&, std::uint32_t first, const CurveStart&)> read;

  // Whether the control runs this piece of a curve. What it does not is written as lines.
  std::function<bool(const geometry::CubicBezier&)> takes = [](const auto&) { return true; };

  // Where the control runs curves as chords of its own that count: how far they leave a piece at
  // the most (mm).
  bool is_run_as_chords = false;
  std::function<double(const geometry::CubicBezier&)> chords_error = [](const auto&) { return 0; };
};

// Whether a curve may start in this state: no compensation, no frames, absolute distances, feed per
// minute. What is not known is not so.
[[nodiscard]] bool may_start(const CurveFormat& format, const ModalState& state);

// The curve that starts in block `first`. Nothing where `format` is nullptr or reads none there, in
// states in which the control refuses curves, and when one of its blocks may be left out, is jumped
// to or stands in a loop.
[[nodiscard]] std::optional<CurveReading> curve_at(const Program& program, std::uint32_t first,
                                                   const ControlState& state,
                                                   const CurveFormat* format,
                                                   std::span<const BlockFlow> flow);

// Whether the feed of the curve that starts in block `first` is written without a decimal point.
[[nodiscard]] bool is_feed_without_point(const Program& program, std::uint32_t first,
                                         const CurveReading& curve);

// One of the curve's pieces as a motion.
[[nodiscard]] Motion motion_of(const CurveMotion& piece, const CurveReading& curve);

}  // namespace batten::gcode
