#include "postproc/smooth/selection/method_times.h"

#include <algorithm>
#include <optional>
#include <string_view>

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

std::vector<MethodTime> joined_times(const TriedStretch& first, const TriedStretch& second) {
  const auto is = [](std::string_view name) {
    return [name](const MethodTime& each) { return each.method == name; };
  };
  std::vector<MethodTime> joined;
  for (const MethodTime& each : first.methods) {
    const auto other = std::ranges::find_if(second.methods, is(each.method));
    const double rest = other == second.methods.end() ? second.time_s : other->time_s;
    joined.push_back({each.method, each.time_s + rest});
  }
  for (const MethodTime& each : second.methods) {
    if (std::ranges::any_of(first.methods, is(each.method))) continue;
    joined.push_back({each.method, first.time_s + each.time_s});
  }
  return joined;
}

}  // namespace batten::postproc
