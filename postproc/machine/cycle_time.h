// How long a chain of pieces takes on a machine, by a model of its control.
// Method: docs/algorithms/cycle_time.md.
#pragma once

#include <span>
#include <vector>

#include "gcode/modal_state.h"
#include "geometry/path.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

struct TimedPiece {
  geometry::PathPiece piece;
  double feed = 0;  // mm/min
};

// Seconds from rest to rest. `path` says whether the control blends or keeps the exact path.
// Linear cost.
[[nodiscard]] double cutting_time(std::span<const TimedPiece> pieces, const Machine& machine,
                                  gcode::PathMode path);

}  // namespace batten::postproc
