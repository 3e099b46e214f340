// One model per kind of control: each turns a chain of pieces into stretches with limits.
// `pieces` have a length above 0 and a feed above 0.
#pragma once

#include <span>

#include "gcode/modal_state.h"
#include "postproc/machine/cycle_time.h"
#include "postproc/machine/machine.h"

namespace batten::postproc {

[[nodiscard]] double look_ahead_time(std::span<const TimedPiece> pieces, const Machine& machine,
                                     gcode::PathMode path);

[[nodiscard]] double grbl_time(std::span<const TimedPiece> pieces, const Machine& machine,
                               gcode::PathMode path);

[[nodiscard]] double linuxcnc_time(std::span<const TimedPiece> pieces, const Machine& machine,
                                   gcode::PathMode path, ChainEnd end);

}  // namespace batten::postproc
