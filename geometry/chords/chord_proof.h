// The proof that a stretch of curve and one straight chord stay near each other, in order.
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

// Each control point is matched to a place on the chord, never going back; curve and chord then
// are the same convex combinations of near places, in order. The chord's own ends need not lie
// on the curve: whoever puts them elsewhere shows that they are near the curve's ends too.
class ChordProof {
 public:
  ChordProof(const Point3& start, const Point3& end, double deviation, int cuts = kProofCuts);

  // The next piece of the curve: within the deviation of the part of the chord that is not yet
  // passed? After a `false` the proof is over.
  bool holds(const CubicBezier& piece) { return holds(piece, cuts_); }

 private:
  bool holds(const CubicBezier& piece, int cuts);
  [[nodiscard]] Vector3 off_chord(const Point3& p) const;
  [[nodiscard]] double farthest(const CubicBezier& piece) const;
  [[nodiscard]] bool near_end(const Point3& p) const;

  Point3 start_;
  Vector3 along_;
  double length_;
  double allowed_;  // mm^2
  int cuts_;
  double reached_ = 0;  // mm along the chord, matched so far
};

// The chord from `start` to `end` against the curve between two parameters, from <= to.
[[nodiscard]] bool chord_proved(const CurvePieces& pieces, double from, double to,
                                ChordProof proof);

// The same for who knows the piece that holds `from`.
[[nodiscard]] bool chord_proved(const CurvePieces& pieces, std::size_t first, double from,
                                double to, ChordProof proof);

}  // namespace batten::geometry
