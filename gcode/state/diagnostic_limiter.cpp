#include "gcode/state/diagnostic_limiter.h"

#include <fmt/format.h>

#include <algorithm>

namespace batten::gcode {

bool DiagnosticLimiter::counts(std::string_view id, SourceSpan where) {
  auto known = std::ranges::find(ids_, id, &OfId::id);
  if (known == ids_.end()) known = ids_.insert(ids_.end(), {id, {}});
  return known->count.counts(where);
}

void DiagnosticLimiter::tell_rest(Diagnostics& found) const {
  for (const OfId& each : ids_) {
    if (each.count.untold == 0) continue;
    found.push_back({Severity::kWarning, each.id, each.count.first_untold,
                     fmt::format("this and {} more blocks after it have the same trouble",
                                 each.count.untold - 1)});
  }
}

}  // namespace batten::gcode
