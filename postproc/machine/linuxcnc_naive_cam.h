// LinuxCNC's canon layer in front of the planner: under G64 P Q it joins straight moves whose
// ends all lie within Q of the joined move.
#pragma once

#include <span>
#include <vector>

#include "postproc/machine/cycle_time.h"

namespace batten::postproc::linuxcnc {

// Lines that are joined become one line. Flat arcs in a plane of constant Z whose middle is
// less than `tolerance` (mm) off the chord become two lines, which then may be joined too.
// A tolerance of 0 changes nothing. Cost: linear, since a joined move has some 100 parts.
[[nodiscard]] std::vector<TimedPiece> join_within(std::span<const TimedPiece> pieces,
                                                  double tolerance);

}  // namespace batten::postproc::linuxcnc
