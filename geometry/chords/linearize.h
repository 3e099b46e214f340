// Chords for a curve: vertices on the curve, each chord as long as it may be.
// Method: docs/algorithms/linearize.md.
#pragma once

#include <vector>

#include "geometry/path/bspline_curve.h"
#include "geometry/path/curve_pieces.h"

namespace batten::geometry {

struct ChordOptions {
  double max_deviation = 0.01;  // mm, curve to chord; > 0
  double max_length = 0;        // mm; 0: no limit
  // Chords are not made shorter than this (mm) unless max_deviation forces it.
  double min_length = 0;
  // A chord's end is searched to this part of its length: with this one, a thousand chords lose a
  // quarter of a chord.
  double precision = 5e-4;
};

// Parameters of the vertices, increasing, both ends of [from, to] included. Every chord
// keeps max_deviation, shown by the control points of the Bezier pieces under it, not by
// samples. The chords of one call are balanced: the last one is not a short remainder.
//
// Where the curve has straight spans, a chord covers them whole.
// Requires degree 3 or less and first() <= from < to <= last(). A corner of the curve is
// always a vertex.
[[nodiscard]] std::vector<double> chord_vertices(const BsplineCurve& curve, double from, double to,
                                                 const ChordOptions& options);

// The same between two places of a curve that is in its pieces already.
[[nodiscard]] std::vector<double> chord_vertices(const MarkedPieces& curve, double from, double to,
                                                 const ChordOptions& options);

}  // namespace batten::geometry
