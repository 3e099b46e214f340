// Chords for a curve: vertices on the curve, each chord as long as it may be; or beside it.
// Method: docs/algorithms/linearize.md.
#pragma once

#include <span>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

struct ChordOptions {
  double max_deviation = 0.01;  // mm, curve to chord; > 0
  // A chord's end is searched to this part of its length: with this one, a thousand chords lose
  // one chord.
  double precision = 2e-3;
  bool balanced = true;  // whether the last chord is no remainder; else as many come sooner
};

struct ChordTuning {
  // [..]: what fails at half and double (docs/ARCHITECTURE.md).
  int secants = 12;          // that look for one end before its interval is halved
  double widest = 4;         // by this factor the length changes from one to the next at most
  double growth = 1.5;       // of the first guess over the chord before, at most
  double full = 0.98;        // part of a full chord from which on the last one is no remainder
  double even = 0.98;        // of the bow of the highest chord the least has, when all are spread
  int spreading_rounds = 5;  // at most, until they are
  // Only so many chords at the end are made shorter: over these a remainder is spread thin.
  std::size_t balanced = 50;
};
inline constexpr ChordTuning kChordTuning;

// Parameters of the vertices, increasing, both ends of [from, to] included. Every chord
// keeps max_deviation, shown by the control points of the Bezier pieces under it, not by
// samples. The chords of one call are spread: the last one is not a short remainder.
//
// Where the curve has straight spans, a chord covers them whole.
// Requires degree 3 or less and first() <= from < to <= last(). A corner of the curve is
// always a vertex.
[[nodiscard]] std::vector<double> chord_vertices(const BsplineCurve& curve, double from, double to,
                                                 const ChordOptions& options);

// The same between two parameters of a curve that is in its pieces already.
[[nodiscard]] std::vector<double> chord_vertices(const MarkedPieces& curve, double from, double to,
                                                 const ChordOptions& options);

// A vertex near a curve, and the parameter of the curve's point that it is for.
struct LinkVertex {
  Point3 place;
  double parameter = 0;
};

// The curve's points themselves.
[[nodiscard]] std::vector<LinkVertex> on_curve(const BsplineCurve& curve,
                                               std::span<const double> parameters);

// Chords that lie on both sides of their curve instead of on its inside (section Balanced chords).
//
// Vertices beside the curve at these parameters (increasing): each is moved to the outside of its
// bend by two thirds of the height of the chords that meet there. So the area between chords and
// curve vanishes, their mean square distance is the least, and the greatest is two thirds of what
// it was. The first and the last vertex and corners of the curve (triple knots) stay on it.
[[nodiscard]] std::vector<LinkVertex> balanced_chords(const BsplineCurve& curve,
                                                      std::span<const double> parameters);

// The same where chords may be of any heights, as those between given vertices are: moved to where
// the chords' mean square distance from the curve, a parabola above each of them, is the least.
[[nodiscard]] std::vector<LinkVertex> nearest_chords(const BsplineCurve& curve,
                                                     std::span<const double> parameters);

// The rms distance of balanced chords over the height of the chords between the same parameters:
// sqrt(4/45), that of a parabola from its mean; sqrt(8/15) for chords whose ends are on the curve.
inline constexpr double kBalancedError = 0.298;
inline constexpr double kChordError = 0.730;

}  // namespace batten::geometry
