// What the curve words of all controls have in common: what goes into their text, and what is
// read out of it. The words of each control stand in a file of their own beside this one.
//
// A curve is a clamped cubic geometry::BsplineCurve, millimetres and absolute. G06.2 and BSPLINE
// say it as it is; POLY, SPL and G5 say its Bezier pieces (BsplineCurve::bezier_pieces), one block
// each, and their functions take std::vector<geometry::CubicBezier>.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "gcode/state/modal_state.h"
#include "gcode/text/number_format.h"
#include "gcode/text/program.h"
#include "geometry/basic/point.h"
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

}  // namespace batten::gcode
