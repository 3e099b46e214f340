// How long a chain of pieces takes on a machine, by a model of its control.
// Method: docs/algorithms/cycle_time.md.
#pragma once

#include <span>
#include <vector>

#include "gcode/state/modal_state.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

struct TimedPiece {
  geometry::PathPiece piece;
  double feed = 0;     // mm/min; 0: as fast as the machine cuts
  bool rapid = false;  // at the rapid rate; `feed` means nothing then
  int bytes = 0;       // of its block, for a control that is fed by a line; 0: not known
};

// What stands behind the chain. It matters on LinuxCNC alone, which brakes with half the
// acceleration where it blends and no more motion comes.
enum class ChainEnd {
  kStop,         // a rapid or another block that ends in a stop
  kEndOfMotion,  // the program's last motion
};

// Seconds from rest to rest. `path` says whether the control blends or keeps the exact path.
// Pieces without length take no time. Linear cost.
//
// Throws std::invalid_argument when a limit of the machine that its model needs is not
// above 0, or a feed is negative or not a number.
[[nodiscard]] double cutting_time(std::span<const TimedPiece> pieces, const Machine& machine,
                                  gcode::PathMode path, ChainEnd end = ChainEnd::kStop);

}  // namespace batten::postproc
