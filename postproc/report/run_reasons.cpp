#include "postproc/report/run_reasons.h"

#include <algorithm>
#include <map>

#include "gcode/state/reason.h"

namespace batten::postproc {

std::vector<ReasonCount> count_reasons(std::span<const RunReport> runs) {
  std::map<std::string_view, ReasonCount> by_id;
  for (const RunReport& run : runs) {
    if (run.status != RunStatus::kKept) continue;
    ReasonCount& count = by_id[run.reason];
    count.id = run.reason;
    ++count.runs;
    count.blocks += run.blocks_in;
  }
  std::vector<ReasonCount> counts;
  for (auto& [id, count] : by_id) {
    const auto explanations = gcode::reason::explanations();
    const auto found = std::ranges::find(explanations, id, &gcode::reason::Explanation::id);
    if (found != explanations.end()) {
      count.text = found->text;
      count.advice = found->advice;
      count.can_be_allowed = found->can_be_allowed;
    }
    counts.push_back(count);
  }
  std::ranges::stable_sort(counts, std::ranges::greater{}, &ReasonCount::blocks);
  return counts;
}

}  // namespace batten::postproc
