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

}  // namespace batten::postproc
