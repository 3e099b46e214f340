// The cutting moves between two events: same path within the tolerance, same feeds along it?
#pragma once

#include <optional>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "postproc/proof/compared_section.h"

namespace batten::postproc {

// Neighbouring cuts of one feed are taken together. The feeds must come in the same order, and
// the path of each must keep the tolerance by itself: so a feed begins where it began.
//
// How much that is the old program says, part by part (gcode::stated_tolerance_mm). Where it
// changes within a feed, the new path is cut where the new program says the same tolerances in the
// same order, and each part must keep its own; where it does not say them, or that fails, the whole
// must keep the least of them. What the new program says is no more than a hint where to cut.
[[nodiscard]] SectionComparison compare_section(const SectionSide& before, const SectionSide& after,
                                                const Promise& promise);

// Only the path, whatever the feeds are; within the least tolerance of all its parts.
[[nodiscard]] geometry::PathComparison compare_whole_path(const SectionSide& before,
                                                          const SectionSide& after,
                                                          const Promise& promise);

// The cuts of one feed, with the matching that proves them.
struct MatchedPart {
  geometry::Path before;
  geometry::Path after;
  geometry::PathMatching matching;
};

// The evidence for the strict reading, a part for each feed; none where both sides have no cuts.
// Nothing where a part is not proved or the feeds are not the same.
[[nodiscard]] std::optional<std::vector<MatchedPart>> match_section(const SectionSide& before,
                                                                    const SectionSide& after,
                                                                    double tolerance_mm);

}  // namespace batten::postproc
