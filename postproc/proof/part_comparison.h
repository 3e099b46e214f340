// Two parts at one feed and one tolerance compared: by their distance in both directions, in
// regions beside it, as the target runs them, on their side, and by their crossings.
#pragma once

#include <vector>

#include "geometry/distance/band_comparison.h"
#include "postproc/proof/compared_section.h"
#include "postproc/proof/path_part.h"

namespace batten::postproc {

// Only their distance. Long paths are compared between positions that both pass, at once where not
// all of these parts are proved.
[[nodiscard]] geometry::BandComparison compare_distance(const PathPartPair& pair,
                                                        const Promise& promise);

// All that is promised, for the tolerance of the promise.
[[nodiscard]] SectionComparison compare_part(const PathPartPair& pair, const Promise& promise);

// `middle`: without the segments that are the same, which cannot be to blame. One for each old
// line.
[[nodiscard]] std::vector<Violation> crossing_violations(const PathPartPair& pair,
                                                         const PathPartPair& middle,
                                                         double tolerance_mm);

}  // namespace batten::postproc
