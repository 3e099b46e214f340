// What a slow line between host and control leaves of the feeds.
#pragma once

#include <span>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"

namespace batten::postproc {

// Lowers feeds to what the line can keep up with: over the blocks that the control holds at a
// time (its look-ahead, half of it before and half behind), the way is run no faster than the bytes
// of these blocks come in. A few short blocks among long ones cost nothing, a long row of them
// runs at the pace of the line. Blocks whose bytes are not known (0) count as none.
void limit_by_stream(std::span<TimedPiece> pieces, const Machine& machine);

}  // namespace batten::postproc
