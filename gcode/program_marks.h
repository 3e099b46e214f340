// The % lines that bound a program on tape: what stands outside them is not its text.
#pragma once

#include "gcode/diagnostic.h"
#include "gcode/program.h"

namespace batten::gcode {

// Makes the blocks outside the % marks opaque. A control that knows the marks skips these
// blocks, one that does not runs them; so nothing may be concluded from them.
//
// The first % line begins the program when blocks with words follow it; otherwise it ends it.
void close_program_marks(Program& program, Diagnostics& found);

}  // namespace batten::gcode
