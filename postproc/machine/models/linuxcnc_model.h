// LinuxCNC's canon layer in front of the planner: under G64 P Q it joins lines that are nearly one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "postproc/machine/models/cycle_time.h"

namespace batten::postproc::linuxcnc {

// A move as the planner gets it: the pieces of the program from the first to the last.
struct JoinedPiece : TimedPiece {
  std::uint32_t first_piece = 0;
  std::uint32_t last_piece = 0;
};

// Lines that are joined become one line. Flat arcs in a plane of constant Z whose middle is
// less than `tolerance` (mm) off the chord become two lines, which then may be joined too. Rapids
// stay as they are.
// A tolerance of 0 changes nothing. Cost: linear, since a joined move has some 100 parts.
[[nodiscard]] std::vector<JoinedPiece> join_within(std::span<const TimedPiece> pieces,
                                                   double tolerance);

}  // namespace batten::postproc::linuxcnc
