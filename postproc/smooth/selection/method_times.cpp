#include "postproc/smooth/selection/method_times.h"

#include <algorithm>
#include <optional>

namespace batten::postproc {

std::vector<MethodTime> method_times(const SmoothedRun& run) {
  std::vector<MethodTime> times;
  for (const Candidate& candidate : run.candidates) {
    const auto known = std::ranges::find(times, candidate.method, &MethodTime::method);
    if (known == times.end()) {
      times.push_back({candidate.method, candidate.times.as_set});
    } else {
      known->time_s = std::min(known->time_s, candidate.times.as_set);
    }
  }
  return times;
}

double lead_of(std::string_view method, double time_s, const std::vector<MethodTime>& times) {
  std::optional<double> other;
  for (const MethodTime& each : times) {
    if (each.method == method) continue;
    other = other ? std::min(*other, each.time_s) : each.time_s;
  }
  return other ? *other - time_s : 0;
}

}  // namespace batten::postproc
