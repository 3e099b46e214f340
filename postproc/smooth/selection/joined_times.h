// What was tried on two neighbouring stretches of a run, when a report tells of them as one.
#pragma once

#include <vector>

#include "postproc/smooth/selection/method_times.h"

namespace batten::postproc {

// What was tried on a stretch of a run.
struct TriedStretch {
  std::vector<MethodTime> methods;
  double time_s = 0;  // as it was
};

// Of two neighbouring stretches as one. A method that was tried on one of them only leaves the
// other as it was.
[[nodiscard]] std::vector<MethodTime> joined_times(const TriedStretch& first,
                                                   const TriedStretch& second);

}  // namespace batten::postproc
