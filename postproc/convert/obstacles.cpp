#include "postproc/convert/obstacles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace batten::postproc {
namespace {

constexpr std::size_t kMostTold = 50;

std::string first_part(std::string_view text) {
  constexpr std::size_t kMostShown = 40;
  return text.size() <= kMostShown ? std::string(text)
                                   : std::string(text.substr(0, kMostShown)) + "..";
}

}  // namespace

void tell_obstacles(const std::vector<Obstacle>& obstacles, const gcode::Program& program,
                    const gcode::Dialect& target, gcode::Diagnostics& found) {
  const std::size_t told = std::min(obstacles.size(), kMostTold);
  for (std::size_t i = 0; i < told; ++i) {
    found.push_back(
        {gcode::Severity::kError, "cannot-convert", obstacles[i].where,
         fmt::format("{} {} (target {})", first_part(program.source.text(obstacles[i].where)),
                     obstacles[i].why, target.name())});
  }
  if (obstacles.size() > told) {
    found.push_back(
        {gcode::Severity::kError, "cannot-convert", obstacles[told].where,
         fmt::format("from here on {} more blocks of this kind", obstacles.size() - told)});
  }
}

}  // namespace batten::postproc
