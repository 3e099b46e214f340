// One dialect per family, each defined in the .cpp of its name. To add one: its .cpp, a line
// here, its place in the list of gcode/dialect.cpp.
#pragma once

#include "gcode/dialect.h"

namespace batten::gcode {

[[nodiscard]] const Dialect& linuxcnc_dialect();
[[nodiscard]] const Dialect& grbl_dialect();

}  // namespace batten::gcode
