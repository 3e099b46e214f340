#include "postproc/smooth/selection/joined_times.h"

#include <algorithm>
#include <string_view>

namespace batten::postproc {

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
