#include "gcode/state/reason_id.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "gcode/state/reason.h"

namespace batten::gcode {

ReasonId::ReasonId(std::string_view id) {
  if (id.empty()) return;
  const auto all = reason::explanations();
  // The constants of reason.h are one text each: nearly always this is enough.
  auto found = std::ranges::find_if(
      all, [id](const reason::Explanation& each) { return each.id.data() == id.data(); });
  if (found == all.end() || found->id != id) {
    found = std::ranges::find(all, id, &reason::Explanation::id);
  }
  if (found == all.end() || found - all.begin() >= std::numeric_limits<std::uint8_t>::max()) {
    throw std::invalid_argument("reason '" + std::string(id) +
                                "' is not one of gcode/state/reason.h");
  }
  place_ = static_cast<std::uint8_t>(found - all.begin() + 1);
}

std::string_view ReasonId::id() const {
  return empty() ? std::string_view() : reason::explanations()[place_ - 1U].id;
}

}  // namespace batten::gcode
