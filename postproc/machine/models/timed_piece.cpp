#include "postproc/machine/models/timed_piece.h"

namespace batten::postproc {

// LinuxCNC goes on under G61 where the path does; to grbl and Klipper it says what they do anyhow.
bool stops_at_block_ends(const Machine& machine, const gcode::PathControl& path) {
  return path.mode == gcode::PathMode::kExactStop ||
         (path.mode == gcode::PathMode::kExactPath && machine.model == ControllerModel::kLookAhead);
}

}  // namespace batten::postproc
