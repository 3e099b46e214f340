// The profile of a chain as speeds that are held and changes between them.
#pragma once

#include <span>
#include <vector>

#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {

// A change of speed without a limit on jerk.
struct SpeedChange {
  double way = 0;           // mm
  double acceleration = 0;  // mm/s^2, the even one that costs as much time
  double jerk = 0;          // mm/s^3 that it may have; infinite: no limit
};

// A speed that is held over some way: on a plateau, or for an instant where the speed is greatest
// or least (no way then).
struct SpeedLevel {
  double velocity = 0;  // mm/s
  double way = 0;       // mm
  SpeedChange after;    // to the next level; nothing behind the last one
};

// From rest to rest.
[[nodiscard]] std::vector<SpeedLevel> speed_levels(std::span<const VelocityStretch> chain,
                                                   std::span<const double> velocities,
                                                   const ProfileRules& rules);

// Lowers speeds until every change between two levels fits as an S-curve into the way that is
// there: that of the change itself and of the faster one of its levels. Levels that are no longer
// reached are gone. The sum of the ways stays. Cost: n log n.
void fit_s_curves(std::vector<SpeedLevel>& levels);

}  // namespace batten::postproc
