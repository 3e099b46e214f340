// Which methods were tried on a run, and how fast what they made would be cut.
#pragma once

#include <string_view>
#include <vector>

#include "postproc/smooth/selection/candidate.h"

namespace batten::postproc {

struct MethodTime {
  std::string_view method;
  double time_s = 0;  // of its fastest candidate, as the control is set
};

// In the order in which they were tried.
[[nodiscard]] std::vector<MethodTime> method_times(const SmoothedRun& run);

// Seconds by which the fastest other method is slower than this time; negative where it is
// faster (what was chosen had other merits). 0 where there is no other.
[[nodiscard]] double lead_of(std::string_view method, double time_s,
                             const std::vector<MethodTime>& times);

// What was tried on two neighbouring stretches of a run, when a report tells of them as one.

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
