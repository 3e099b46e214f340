// What a feed plan may ask of a machine.
#pragma once

#include "postproc/machine/machine.h"
#include "postproc/machine/planner/feed_plan_path.h"

namespace batten::postproc {

// The limits of X, Y and Z, those of the path, and the servo period. `feed` (mm/s): as programmed,
// where it is less than what the machine takes. Rotary axes are not part of such a path.
[[nodiscard]] KinematicPathLimits path_limits_of(const Machine& machine,
                                                 double feed = Machine::kNone);

}  // namespace batten::postproc
