#include "postproc/machine/models/cycle_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry/basic/operations.h"
#include "geometry/basic/rounding.h"
#include "postproc/machine/machine_fields.h"
#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/junction_speed.h"
#include "postproc/machine/models/planned_chain.h"

namespace batten::postproc {
namespace {

void require_usable(const Machine& machine) {
  for (const MachineProblem& problem : problems_of(machine)) {
    throw std::invalid_argument(fmt::format("machine \"{}\": {} is {}, expected {}", machine.name,
                                            problem.key, problem.value, problem.expected));
  }
}

// Klipper runs all before the first F at this; mm/min.
constexpr double kKlipperFirstFeed = 1500;

// Without a feed above any diagonal of the axes (sqrt(3)), so that it limits nothing; mm/min.
double feed_of(const TimedPiece& p, const Machine& machine, double feed_override) {
  const bool has_rapids = machine.model != ControllerModel::kKlipper;
  if (p.feed > 0 && !(p.rapid && has_rapids)) return feed_override * p.feed;
  if (!has_rapids) return kKlipperFirstFeed;
  return axis_velocities(machine, p.rapid).maxCoeff() * 60 * 2;
}

// Lowers feeds to what the line can keep up with: over the blocks that the control holds at a
// time (its look-ahead, half of it before and half after), the way is run no faster than the bytes
// of these blocks come in. A few short blocks among long ones cost nothing, a long row of them
// runs at the pace of the line. Blocks whose bytes are not known (0) count as none.
void limit_by_stream(std::span<TimedPiece> pieces, const Machine& machine) {
  if (!std::isfinite(machine.stream_rate)) return;
  const std::size_t n = pieces.size();
  std::vector<double> way(n + 1, 0.0);    // mm of the pieces before
  std::vector<double> bytes(n + 1, 0.0);  // of their blocks
  for (std::size_t i = 0; i < n; ++i) {
    way[i + 1] = way[i] + geometry::length_of(pieces[i].piece);
    bytes[i + 1] = bytes[i] + pieces[i].bytes;
  }
  const auto half = static_cast<std::size_t>(machine.look_ahead) / 2;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t first = i > half ? i - half : 0;
    const std::size_t last = std::min(n, i + half + 1);
    const double sent = bytes[last] - bytes[first];
    if (!(sent > 0)) continue;
    const double pace = (way[last] - way[first]) / sent * machine.stream_rate;  // mm/s
    pieces[i].feed = std::min(pieces[i].feed, pace * 60);
  }
}

}  // namespace

std::vector<TimedPiece> with_length_and_feed(std::span<const TimedPiece> pieces,
                                             const Machine& machine, double feed_override) {
  std::vector<TimedPiece> moving;
  moving.reserve(pieces.size());
  bool says_speed = false;
  for (const TimedPiece& p : pieces) {
    if (!(p.feed >= 0)) {
      throw std::invalid_argument(fmt::format("feed is {} mm/min, expected 0 or above", p.feed));
    }
    says_speed |= p.says_speed;
    if (!(geometry::length_of(p.piece) > geometry::kSamePlace)) continue;
    moving.push_back(p);
    moving.back().says_speed = std::exchange(says_speed, false);
    moving.back().feed = feed_of(p, machine, feed_override);
  }
  limit_by_stream(moving, machine);
  return moving;
}

StretchChain stretches_of(std::span<const TimedPiece> pieces, const Machine& machine,
                          const gcode::PathControl& path, ChainEnd end, WithPositions places) {
  require_usable(machine);
  switch (machine.model) {
    case ControllerModel::kLinuxcnc:
      return linuxcnc_stretches(pieces, machine, path, end, places);
    case ControllerModel::kGrbl:
    case ControllerModel::kGrblhal:
    case ControllerModel::kMarlin:
      return grbl_stretches(pieces, machine, path, places);
    case ControllerModel::kKlipper:
      return klipper_stretches(pieces, machine, path, places);
    case ControllerModel::kLookAhead:
      break;
  }
  return look_ahead_stretches(pieces, machine, path, places);
}

bool takes_a_plan(const StretchChain& chain, double time) {
  constexpr double kLeast = 0.01;
  return chain.in_slow_curves > kLeast * time;
}

TimedChain::TimedChain(std::span<const TimedPiece> pieces, const Machine& machine,
                       double feed_override)
    : machine_(machine) {
  require_usable(machine);
  moving_ = with_length_and_feed(pieces, machine, feed_override);
}

double TimedChain::time(const gcode::PathControl& path, ChainEnd end, WorthAPlan worth) const {
  const StretchChain chain = stretches_of(moving_, machine_, path, end, WithPositions::kNo);
  const double time = profile_time(chain.stretches, chain.rules);
  geometry::count_operations(10 * moving_.size());
  const double slow = chain.in_slow_curves;
  if (slow < worth.seconds * static_cast<double>(moving_.size()) || !takes_a_plan(chain, time)) {
    return time;
  }
  return PlannedMotion(moving_, machine_, FeedPlanner::kJerk, path, kQuickPlanDensity).duration();
}

double cutting_time(std::span<const TimedPiece> pieces, const Machine& machine,
                    const gcode::PathControl& path, ChainEnd end) {
  return TimedChain(pieces, machine).time(path, end);
}

}  // namespace batten::postproc
