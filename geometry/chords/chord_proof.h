// The proof that a section of curve and one straight chord stay near each other, in order.
// Method: docs/algorithms/linearize.md, step 2.
#pragma once

#include <cstddef>

#include "geometry/basic/point.h"
#include "geometry/path/curve_pieces.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// How often a Bezier piece is cut to tighten the bound of its control points: twice where it is
// farthest from the chord, there the bound of a flat bend is sharp at once, then in halves, each of
// which quarters what a twist leaves. After seven halves that is 2e-5 of the deviation, after ten
// 3e-7.
inline constexpr int kProofCuts = 9;
inline constexpr int kSharpProofCuts = 12;

// From a start along a unit vector, which is zero where both ends are one point.
class StraightLine {
 public:
  StraightLine(const Point3& start, const Point3& end);

  [[nodiscard]] double foot(const Point3& p) const;  // mm from the start, on the line's length
  [[nodiscard]] Vector3 off(const Point3& p) const;  // from the line without ends
  // From the point of the line at so many mm, and from the nearest one.
  [[nodiscard]] double squared_distance(const Point3& p, double at) const;
  [[nodiscard]] double squared_distance(const Point3& p) const {
    return squared_distance(p, foot(p));
  }

 private:
  Point3 start_;
  double length_;
  Vector3 along_ = Vector3::Zero();
};

// Each control point is matched to a point of the chord, never going back; curve and chord then
// are the same convex combinations of near points, in order. The chord's own ends need not lie
// on the curve: whoever puts them elsewhere shows that they are near the curve's ends too.
class ChordProof {
 public:
  ChordProof(const Point3& start, const Point3& end, double deviation, int cuts = kProofCuts);

  // The next piece of the curve: within the deviation of the part of the chord that is not yet
  // passed? After a `false` the proof is over.
  bool holds(const CubicBezier& piece) { return holds(piece, cuts_); }

 private:
  bool holds(const CubicBezier& piece, int cuts);
  [[nodiscard]] double farthest(const CubicBezier& piece) const;

  StraightLine line_;
  double allowed_;  // mm^2
  int cuts_;
  double reached_ = 0;  // mm along the chord, matched so far
};

// The chord from `start` to `end` against the curve between two parameters, from <= to.
[[nodiscard]] bool chord_proved(const CurvePieces& pieces, double from, double to,
                                ChordProof proof);

// Greatest distance (mm) of the curve between two parameters, from < to, from the chord between its
// points there; not at samples. Right to 1e-12 of itself and to rounding: pieces are halved until
// their control points, which bound them, and their ends agree.
[[nodiscard]] double chord_deviation(const CurvePieces& pieces, double from, double to);

// The first parameter after `from` where the curve is `distance` (mm, > 0) away from its tangent at
// `from`, or `to` where it never is before; right to rounding of the parameter.
[[nodiscard]] double leaves_tangent_at(const CurvePieces& pieces, double from, double to,
                                       double distance);

// How far (mm) a path is beside a curve on either side of the way of travel, seen from above. With
// the workpiece to the right, what is left of the curve leaves material and what is right of it
// cuts into the workpiece; to the left it is the other way round.
struct BesideCurve {
  double left = 0;
  double right = 0;
};

// A line that stands for the curve between two parameters, from < to: the greatest distances along
// the normal of the line. Both 0 for a line that is upright or a point.
[[nodiscard]] BesideCurve line_beside(const CurvePieces& pieces, double from, double to,
                                      const Line& line);

// A chord and the section of curve between its ends.
struct ChordHeight {
  double chord = 0;   // mm, its length
  double height = 0;  // mm: no point of the curve is farther from the chord's line
  // Whether the curve goes forward along the chord from its start to its end. Then each point is
  // matched with its foot, in order, and curve and chord are within `height` of each other.
  bool in_order = false;
};

// The coordinates of the control points of a piece.
struct ControlCoordinates {
  Eigen::Array4d x;
  Eigen::Array4d y;
  Eigen::Array4d z;
};

// Chords that start at one point of the curve. The pieces must live as long.
class ChordsFrom {
 public:
  ChordsFrom(const CurvePieces& pieces, double from)
      : ChordsFrom(pieces, pieces.index_of(from), from) {}
  // `piece`: that holds `from`.
  ChordsFrom(const CurvePieces& pieces, std::size_t piece, double from);

  // The chord to `end` > from. Its height is greater than the greatest distance of the curve by
  // less than 1e-4 of it; by less than 1e-3 where the curve twists wildly between two knots.
  [[nodiscard]] ChordHeight to(double end) const;

  // Whether a point between two knots, or a knot, is farther than `distance` (mm) from the chord to
  // `end`: a quick answer to whether it is hopeless.
  [[nodiscard]] bool leaves(double end, double distance) const;

  [[nodiscard]] double from() const { return from_; }
  [[nodiscard]] const Point3& start() const { return start_; }
  [[nodiscard]] std::size_t first_piece() const { return first_; }

 private:
  [[nodiscard]] std::size_t piece_at(double u) const;
  [[nodiscard]] ControlCoordinates part_before(std::size_t i, double end) const;

  const CurvePieces& pieces_;
  double from_;
  std::size_t first_;
  Point3 start_;
  double left_ = 1;          // of the first piece's parameter, after the start
  ControlCoordinates rest_;  // of the first piece there, seen from the start
};

}  // namespace batten::geometry
