// How far a stretch of curve leaves the chord between two of its places.
// Method: docs/algorithms/linearize.md, step 2.
#pragma once

#include <cstddef>

#include "geometry/basic/point.h"
#include "geometry/numeric/four_numbers.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

// A chord and the stretch of curve between its ends.
struct ChordHeight {
  double chord = 0;   // mm, its length
  double height = 0;  // mm: no place of the curve is farther from the chord's line
  // Whether the curve goes forward along the chord from its start to its end. Then each place is
  // matched with its foot, in order, and curve and chord are within `height` of each other.
  bool in_order = false;
};

// The coordinates of the control points of a piece.
struct ControlCoordinates {
  Four x;
  Four y;
  Four z;
};

// Chords that start at one place of the curve. The pieces must live as long.
class ChordsFrom {
 public:
  ChordsFrom(const CurvePieces& pieces, double from)
      : ChordsFrom(pieces, pieces.index_of(from), from) {}
  // The same for who knows the piece that holds `from`.
  ChordsFrom(const CurvePieces& pieces, std::size_t piece, double from);

  // The chord to `end` > from. Its height is greater than the greatest distance of the curve by
  // less than 1e-4 of it; by less than 1e-3 where the curve twists wildly between two knots.
  [[nodiscard]] ChordHeight to(double end) const;

  // Whether a place between two knots, or a knot, is farther than `distance` (mm) from the chord to
  // `end`: a quick answer to whether it is hopeless.
  [[nodiscard]] bool leaves(double end, double distance) const;

  [[nodiscard]] double from() const { return from_; }
  [[nodiscard]] const Point3& start() const { return start_; }
  [[nodiscard]] std::size_t first_piece() const { return first_; }

 private:
  [[nodiscard]] std::size_t piece_at(double u) const;
  [[nodiscard]] ControlCoordinates seen_from_start(const CubicBezier& piece) const;
  [[nodiscard]] ControlCoordinates part_before(std::size_t i, double end) const;

  const CurvePieces& pieces_;
  double from_;
  std::size_t first_;
  Point3 start_;
  double left_ = 1;          // of the first piece's parameter, behind the start
  ControlCoordinates rest_;  // of the first piece there, seen from the start
};

}  // namespace batten::geometry
