// Chords whose ends are as far from the tangent at their starts as the tolerance: Hamdan's BLCA,
// for any curve. Method: docs/algorithms/hamdan.md. A reproduction; see geometry/chords/ilca.h.
#pragma once

#include <span>

#include "geometry/chords/ilca.h"
#include "geometry/path/path.h"

namespace batten::geometry {

// From each vertex on to where the curve has left the tangent there by `tolerance` (mm, > 0). A
// step is shortened where a chord over it would deviate by more than the tolerance: an inflection,
// or a curve that turns back; on a curve that bends to one side no chord does. A corner is always a
// vertex.
//
// Requires degree 3 or less and first() <= from < to <= last(). Throws std::invalid_argument when
// `tolerance` is not above 0.
[[nodiscard]] ChordRow blca(const BsplineCurve& curve, double from, double to, double tolerance);

// The tool path that the paper draws over these vertices: from each a jump of length `tolerance`
// across the tangent, to the side where the curve goes, then along the tangent until abeam of the
// next vertex, which is met there when the step was a whole one. Not a path to be cut: it leaves
// the curve by the tolerance in every step.
//
// Requires `parameters` of the curve, increasing.
[[nodiscard]] Path blca_tool_path(const BsplineCurve& curve, std::span<const double> parameters,
                                  double tolerance);

}  // namespace batten::geometry
