// Blocks to motions in millimetres: the only place that knows inches and increments.
#pragma once

#include "gcode/diagnostic.h"
#include "gcode/motion.h"
#include "gcode/program.h"

namespace batten::gcode {

struct ReadOptions {
  Units units = Units::kUnknown;  // --units: what a program that names no unit means
};

// Follows the program from its first block to its last, as a control would, without loops
// and calls: blocks that would need them are opaque.
//
// State at the start: units as in the options; everything else as controls have it after
// power-on (absolute, XY plane, feed per minute, compensations off), the position unknown.
//
// Adds errors for what a control would refuse (two words of one group, an arc whose radii
// differ by more than 0.1 % and 0.0283 mm) - as diagnostics; the block is opaque then.
[[nodiscard]] Interpretation interpret(const Program& program, const ReadOptions& options,
                                       Diagnostics& found);

}  // namespace batten::gcode
