// Fewer vertices that say the same.
#pragma once

#include <vector>

#include "postproc/report/page_path.h"

namespace batten::postproc {

struct Thinning {
  double error = 0.0001;     // mm, of places and of offsets
  double speed_error = 1.0;  // mm/min
};

// Leaves out vertices that lie between two that stay, on the straight way from the one to the
// other, within these errors: place, offset and both speeds. Ends of chains, and vertices where the
// kind of move, the run or the feed changes, stay. Linear cost.
[[nodiscard]] std::vector<PageVertex> thinned(const std::vector<PageVertex>& vertices,
                                              const Thinning& thinning);

}  // namespace batten::postproc
