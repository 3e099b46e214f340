// The arc that LinuxCNC puts into a corner under G64.
#pragma once

#include <optional>

#include "postproc/machine/linuxcnc_segment.h"

namespace batten::postproc::linuxcnc {

struct BlendArc {
  double radius = 0;    // mm
  double turn = 0;      // radians
  double trim = 0;      // mm that it takes from the end of the one move and the start of the other
  double velocity = 0;  // mm/s
  double acceleration = 0;  // mm/s^2
};

// Nothing where the two moves have no blend arc: they do not lie in one plane, or turn back.
// `tolerance` (mm) is P; 0 stands for a quarter of the shorter move.
[[nodiscard]] std::optional<BlendArc> blend_arc(const Segment& before, const Segment& after,
                                                const Machine& machine, double tolerance);

}  // namespace batten::postproc::linuxcnc
