#include "postproc/machine/cycle_time.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string_view>

#include "geometry/numeric.h"
#include "postproc/machine/controller_models.h"

namespace batten::postproc {
namespace {

void require_positive(double value, std::string_view name, const Machine& machine) {
  if (value > 0) return;
  throw std::invalid_argument(
      fmt::format("machine \"{}\": {} is {}, expected above 0", machine.name, name, value));
}

void require_usable(const Machine& machine) {
  require_positive(machine.max_velocity(), "max_velocity", machine);
  require_positive(machine.max_acceleration(), "max_acceleration", machine);
  require_positive(machine.block_period, "block_period", machine);
  require_positive(machine.look_ahead, "look_ahead", machine);
  if (machine.model == ControllerModel::kGrbl) {
    require_positive(machine.junction_deviation, "junction_deviation", machine);
    require_positive(machine.arc_tolerance, "arc_tolerance", machine);
  }
}

std::vector<TimedPiece> with_length_and_feed(std::span<const TimedPiece> pieces,
                                             const Machine& machine) {
  std::vector<TimedPiece> moving;
  moving.reserve(pieces.size());
  for (const TimedPiece& p : pieces) {
    if (!(p.feed >= 0)) {
      throw std::invalid_argument(fmt::format("feed is {} mm/min, expected 0 or above", p.feed));
    }
    if (geometry::length_of(p.piece) <= geometry::kSamePlace) continue;
    const double fastest = machine.max_velocity() * 60 * 2;  // above any axis diagonal (sqrt(3))
    moving.push_back({p.piece, p.feed > 0 ? p.feed : fastest});
  }
  return moving;
}

}  // namespace

double cutting_time(std::span<const TimedPiece> pieces, const Machine& machine,
                    gcode::PathMode path, ChainEnd end) {
  require_usable(machine);
  const std::vector<TimedPiece> moving = with_length_and_feed(pieces, machine);
  switch (machine.model) {
    case ControllerModel::kLinuxcnc:
      return linuxcnc_time(moving, machine, path, end);
    case ControllerModel::kGrbl:
      return grbl_time(moving, machine, path);
    case ControllerModel::kLookAhead:
      break;
  }
  return look_ahead_time(moving, machine, path);
}

}  // namespace batten::postproc
