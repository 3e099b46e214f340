// What a caller's numbers have to be.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

namespace batten::geometry {

// Throws std::invalid_argument where it does not hold: "fit_arcs: max_sweep 3.5, expected above 0".
inline void require(bool holds, std::string_view what, double found, std::string_view expected) {
  if (!holds) throw std::invalid_argument(fmt::format("{} {}, expected {}", what, found, expected));
}

}  // namespace batten::geometry
