// Hamdan's ways to linearize, for any curve: W. K. Hamdan, H. L. Alwan, B. M. Hussein, 2005.
// Reproductions: chord_vertices (geometry/chords/linearize.h) needs fewer chords.
// Method: docs/algorithms/hamdan.md.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/chords/chord_proof.h"
#include "geometry/path/bspline_curve.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// How many chords may be looked for, for each piece of the curve, and how many deviations be read
// for each of these chords: equal steps are as short everywhere as the tightest bend asks for, and
// cusps of a noisy path may ask for millions.
inline constexpr double kIlcaChordsPerPiece = 16;
inline constexpr double kIlcaLeastBound = 1000;  // chords, of a curve of few pieces
inline constexpr double kIlcaReadings = 16;      // of each chord

struct IlcaOptions {
  double max_deviation = 0.01;  // mm, curve to chord; > 0
  double first_step = 0;        // of the parameter; 0: one step to begin with
};

// A curve's chords, each between neighbours of `parameters`.
struct ChordRow {
  std::vector<double> parameters;  // increasing, both ends included; corners are always vertices
  double deviation = 0;            // mm, greatest distance of the curve from its chords
  std::size_t readings = 0;        // deviations of chords that were asked for (ilca)
};

// ILCA: n equal steps of the parameter between two corners of the curve, n the least number from
// ceil(length / first_step) on for which no chord deviates by more than max_deviation. Numbers n
// are passed over where the deviation found for a smaller one says that they are too few: it goes
// with 1 / n^2. Nothing where that takes more chords or more work than the bounds above allow.
//
// Requires degree 3 or less and first() <= from < to <= last(). Throws std::invalid_argument when
// an option is outside its range.
[[nodiscard]] std::optional<ChordRow> ilca(const BsplineCurve& curve, double from, double to,
                                           const IlcaOptions& options);

// BLCA: from each vertex on to where the curve has left the tangent there by `tolerance` (mm, > 0).
// A step is shortened where a chord over it would deviate by more than the tolerance: an
// inflection, or a curve that turns back; on a curve that bends to one side no chord does.
//
// Requires and throws as ilca.
[[nodiscard]] ChordRow blca(const BsplineCurve& curve, double from, double to, double tolerance);

// Lines along the tangents of a curve, with jumps between them.
struct TangentLines {
  Path path;              // lines and jumps, in the order in which they are run
  std::size_t jumps = 0;  // among them
  double jumped = 0;      // mm, all jumps together
  BesideCurve beside;     // of the lines, the greatest
};

// The tool path that the paper draws over the vertices of BLCA, for comparison only: from each
// vertex a line along the tangent until abeam of the next vertex, moved by `moved` (mm, >= 0)
// across it to the side where the curve goes, and a jump to where it begins. Unmoved, the lines are
// on the outside of each bend by up to the tolerance. Moved by the tolerance, which is the paper's
// correction, they are on its inside, each whole step ends on the curve, and the length of the path
// is equation (20). It ends where the last line does, beside the end of the curve.
//
// `parameters`: of `curve`, two or more, increasing. Requires degree 3 or less.
[[nodiscard]] TangentLines tangent_lines(const BsplineCurve& curve,
                                         std::span<const double> parameters, double moved);

}  // namespace batten::geometry
