// Does the new program do what the old one did, within the tolerance? Believes only text:
// it takes two programs as they were read and knows nothing of how the new one was made.
//
// What is compared, in order: every block that acts (M, S, T words, coordinate systems,
// dwells, opaque blocks ..) must stand in both, the same; rapids must have the same ends; and
// between them each stretch of cutting moves at one feed must keep the tolerance, both ways
// and in order (geometry/distance/path_distance). What counts as an event:
// postproc/proof/program_events.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "postproc/proof/event_violations.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/section_comparison.h"

namespace batten::postproc {

struct Verification {
  std::vector<Violation> violations;  // empty: proved
  std::vector<Stretch> stretches;     // in order; identical ones are not listed
  double deviation_mm = 0;            // greatest proved bound
  std::uint32_t deviation_line = 0;   // of the old program
  double corner_mm = 0;               // greatest of the stretches
  std::size_t events_compared = 0;
  [[nodiscard]] bool proved() const { return violations.empty(); }
};

// Feeds are the same when they differ by less than a millionth: they are printed again.
// Requires a tolerance > 0 (throws std::invalid_argument otherwise).
[[nodiscard]] Verification verify(const ReadProgram& before, const ReadProgram& after,
                                  const Promise& promise);

// As `verify`, by several threads, and the same result for any number of them: stretches do not
// look at each other. `threads`: 0: all cores.
[[nodiscard]] Verification verify_in_parallel(const ReadProgram& before, const ReadProgram& after,
                                              const Promise& promise, int threads);

}  // namespace batten::postproc
