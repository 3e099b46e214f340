#include "gcode/state/motion.h"

#include <algorithm>

namespace batten::gcode {

std::span<const Motion> motions_of(const Interpretation& read, std::uint32_t block) {
  const std::int32_t first = read.blocks[block].motion;
  if (first < 0) return {};
  const auto rest = std::span(read.motions).subspan(static_cast<std::size_t>(first));
  std::size_t count = 1;
  while (count < rest.size() && rest[count].block == rest[0].block) ++count;
  return rest.first(count);
}

std::optional<double> least_stated_mm(const Interpretation& read, std::uint32_t first,
                                      std::uint32_t last) {
  // One state for all of them, nearly always.
  if (read.stated.empty()) {
    return read.states.empty() ? std::nullopt : stated_tolerance_mm(read.states.front());
  }
  std::optional<double> least;
  std::optional<std::uint32_t> asked;
  for (std::uint32_t block = first; block <= last; ++block) {
    const BlockMeaning& meaning = read.blocks[block];
    if (meaning.motion < 0 || asked == meaning.state_after) continue;
    asked = meaning.state_after;
    const std::optional<double> mm = stated_tolerance_mm(read.states[*asked]);
    if (mm) least = std::min(*mm, least.value_or(*mm));
  }
  return least;
}

}  // namespace batten::gcode
