// Chords whose ends are as far from the tangent at their starts as the tolerance: Hamdan's BLCA,
// for any curve. Method: docs/algorithms/hamdan.md. A reproduction; see geometry/chords/ilca.h.
#pragma once

#include "geometry/chords/ilca.h"

namespace batten::geometry {

// From each vertex on to where the curve has left the tangent there by `tolerance` (mm, > 0). A
// step is shortened where a chord over it would deviate by more than the tolerance: an inflection,
// or a curve that turns back; on a curve that bends to one side no chord does. A corner is always a
// vertex.
//
// Requires degree 3 or less and first() <= from < to <= last(). Throws std::invalid_argument when
// `tolerance` is not above 0.
[[nodiscard]] ChordRow blca(const BsplineCurve& curve, double from, double to, double tolerance);

}  // namespace batten::geometry
