// The cutting moves between two events: same path within the tolerance, same feeds along it?
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/basic/point.h"
#include "postproc/proof/program_events.h"
#include "postproc/proof/verification.h"

namespace batten::postproc {

// The moves of one program between two events.
struct StretchSide {
  const ReadProgram* read = nullptr;
  std::span<const Cut> cuts;
  // Where the tool stands before the first of them; not always known.
  std::optional<geometry::Point3> start;
  std::uint32_t line = 0;  // to name when there are no cuts: of the event before
};

struct StretchResult {
  std::vector<Stretch> stretches;  // one per feed that was compared; identical ones are left out
  std::vector<Violation> violations;
};

// Neighbouring cuts of one feed are taken together. The feeds must come in the same order, and
// the path of each must keep the tolerance by itself: so a feed begins where it began.
[[nodiscard]] StretchResult compare_stretch(const StretchSide& before, const StretchSide& after,
                                            const Promise& promise);

// Only the path, whatever the feeds are.
[[nodiscard]] geometry::PathComparison compare_whole_path(const StretchSide& before,
                                                          const StretchSide& after,
                                                          const Promise& promise);

}  // namespace batten::postproc
