// A motion as the models of controls time it.
#pragma once

#include "gcode/state/modal_state.h"
#include "geometry/path/path.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

struct TimedPiece {
  geometry::PathPiece piece;
  double feed = 0;          // mm/min; 0: as fast as the machine cuts
  bool rapid = false;       // at the rapid rate; on Klipper at `feed`, the last one
  int bytes = 0;            // of its block, for a control that is fed by a line; 0: not known
  bool says_speed = false;  // of the spindle: LinuxCNC begins such a block at rest
  bool goes_on = false;     // of the block of the piece before it: a curve in several pieces
  float arcs = 0;           // that LinuxCNC makes of a piece of a curve; 0: as a G5 for itself
};

// Whether the control comes to rest at the end of every block, even where the path runs straight
// on: under exact stop, and under G61 where that is another word for it.
[[nodiscard]] bool stops_at_block_ends(const Machine& machine, const gcode::PathControl& path);

}  // namespace batten::postproc
