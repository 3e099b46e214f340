// The proof that a stretch of curve and one straight chord stay near each other, in order.
// Method: docs/algorithms/linearize.md, step 2.
#pragma once

#include "geometry/curve_pieces.h"
#include "geometry/path.h"
#include "geometry/point.h"

namespace batten::geometry {

// How often a Bezier piece is halved to tighten the bound of its control points. Each halving
// quarters what the bound has too much (a third of the deviation at first), so seven leave 2e-5
// of it and ten 3e-7.
inline constexpr int kProofHalvings = 7;
inline constexpr int kSharpProofHalvings = 10;

// Each control point is matched to a place on the chord, never going back; curve and chord then
// are the same convex combinations of near places, in order. The chord's own ends need not lie
// on the curve: whoever puts them elsewhere shows that they are near the curve's ends too.
class ChordProof {
 public:
  ChordProof(const Point3& start, const Point3& end, double deviation,
             int halvings = kProofHalvings);

  // The next piece of the curve: within the deviation of the part of the chord that is not yet
  // passed? After a `false` the proof is over.
  bool holds(const CubicBezier& piece) { return holds(piece, halvings_); }

 private:
  bool holds(const CubicBezier& piece, int halvings);
  [[nodiscard]] bool near_end(const Point3& p) const;

  Point3 start_;
  Vector3 along_;
  double length_;
  double allowed_;  // mm^2
  int halvings_;
  double reached_ = 0;  // mm along the chord, matched so far
};

// The chord from `start` to `end` against the curve between two parameters, from <= to.
[[nodiscard]] bool chord_proved(const CurvePieces& pieces, double from, double to,
                                ChordProof proof);

}  // namespace batten::geometry
