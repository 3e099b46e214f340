// How exact a program says that its parts have to be. The words for it, and what holds how long:
// docs/tolerances.md, "A tolerance for each part".
#pragma once

#include <optional>

#include "gcode/state/code_table.h"

namespace batten::gcode {

// Of a comment: in the units that it says, or that the program had there. Units::kUnknown: in those
// of the motions that it is for.
struct StatedLength {
  double value = 0;  // > 0
  Units units = Units::kUnknown;
  bool operator==(const StatedLength&) const = default;
};

// What holds between two blocks: the last comment of a CAM system, and what the control was told
// for its own smoothing (CYCLE832, cycle 32). Each holds until another one of its kind.
struct StatedTolerances {
  std::optional<StatedLength> by_comment;
  std::optional<double> by_control_mm;
  bool operator==(const StatedTolerances&) const = default;
};

}  // namespace batten::gcode
