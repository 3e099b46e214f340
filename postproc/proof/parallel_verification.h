// The same proof by several threads: stretches do not look at each other.
#pragma once

#include "postproc/proof/verification.h"

namespace batten::postproc {

// As `verify`, and the same result for any number of threads. `threads`: 0: all cores.
[[nodiscard]] Verification verify_in_parallel(const ReadProgram& before, const ReadProgram& after,
                                              const Promise& promise, int threads);

}  // namespace batten::postproc
