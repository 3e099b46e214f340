// When controls refuse an arc, as functions of its printed numbers.
#pragma once

#include <string_view>

#include "gcode/control/control.h"
#include "geometry/path/path.h"

namespace batten::gcode {

// Why the control is not given the printed arc (end and centre offsets rounded), empty where it is:
// below its least radius, or refused by its rule, or said by numbers that nobody writes.
[[nodiscard]] std::string_view arc_refusal(const Control& control, const geometry::Arc& printed,
                                           Units units);

}  // namespace batten::gcode
