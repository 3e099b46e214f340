// How a control passes the joints of motions: G61, G61.1 and G64 with its P and Q.
#pragma once

#include <optional>

#include "gcode/state/block_words.h"
#include "gcode/state/code_table.h"

namespace batten::gcode {

// The mode, and how far a blend may leave the joints (LinuxCNC).
struct PathControl {
  PathMode mode = PathMode::kBlending;
  // mm, P and Q. Nothing: the program has not said. Each G64 says both: without P there is no
  // limit, which is 0, and Q is what P is.
  std::optional<double> blend_tolerance = {};
  std::optional<double> naive_cam_tolerance = {};

  constexpr PathControl(PathMode mode = PathMode::kBlending) : mode(mode) {}
  bool operator==(const PathControl&) const = default;
};

// After a word that sets the mode, in a block of such words and units. Values that are no numbers
// count as 0.
[[nodiscard]] PathControl path_control_of(PathMode mode, const BlockWords& words, Units units);

}  // namespace batten::gcode
