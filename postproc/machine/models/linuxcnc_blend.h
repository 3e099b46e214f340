// The arc that LinuxCNC puts into a corner under G64.
#pragma once

#include <optional>

#include "postproc/machine/models/linuxcnc_segment.h"

namespace batten::postproc::linuxcnc {

struct BlendArc {
  double radius = 0;        // mm
  double turn = 0;          // radians
  double trim_before = 0;   // mm that it takes from the end of the move before
  double trim_after = 0;    // mm that it takes from the start of the move after
  double velocity = 0;      // mm/s
  double acceleration = 0;  // mm/s^2
};

// Nothing where the two moves have no blend arc: they do not lie in one plane, turn
// back, or bend so much that no arc fits within the tolerance.
// `tolerance` (mm) is P; 0 stands for a quarter of the shorter move.
[[nodiscard]] std::optional<BlendArc> blend_arc(const Segment& before, const Segment& after,
                                                const Machine& machine, double tolerance);

}  // namespace batten::postproc::linuxcnc
