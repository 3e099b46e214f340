// The time of one chain of pieces under several settings of its control.
#pragma once

#include <span>
#include <vector>

#include "gcode/state/modal_state.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"

namespace batten::postproc {

// What the settings have in common is done once.
class TimedChain {
 public:
  // Throws as cutting_time does.
  TimedChain(std::span<const TimedPiece> pieces, const Machine& machine);

  // As cutting_time. `machine` may differ from that of the chain in what it makes of corners and
  // of lines that it joins, not in its limits.
  [[nodiscard]] double time(const Machine& machine, gcode::PathMode path,
                            ChainEnd end = ChainEnd::kStop) const;

  // From now on no piece has a feed.
  void lift_feeds(const Machine& machine);

 private:
  std::vector<TimedPiece> moving_;
};

}  // namespace batten::postproc
