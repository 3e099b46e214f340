// Memory that is free, but still held for what may be asked for next.
#pragma once

namespace batten::postproc {

// Gives it back to the system, where the C library can: between two stages that need much of it,
// since what one left in pieces is of little use to the other. Not where it is soon asked for again.
void give_back_free_memory();

}  // namespace batten::postproc
