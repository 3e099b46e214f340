// How grblHAL and Marlin run a G5: as chords, which they find by halving and doubling the step of
// the parameter until the middle of each chord is near its curve. Facts and sources:
// docs/controllers/grbl_family.md.
#pragma once

#include <vector>

#include "geometry/path/path.h"

namespace batten::gcode {

// The parameters at which their chords end, increasing, the last one 1.
[[nodiscard]] std::vector<double> chopped_at(const geometry::CubicBezier& piece);

// mm: no place of the piece is further from its chord. An upper bound, by the hull of the control
// points of each part; right to some percent where all chords bend one way.
[[nodiscard]] double chopping_error(const geometry::CubicBezier& piece);

}  // namespace batten::gcode
