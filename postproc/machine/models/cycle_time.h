// How long a chain of pieces takes on a machine, by a model of its control.
// Method: docs/algorithms/cycle_time.md.
#pragma once

#include <span>
#include <vector>

#include "gcode/state/modal_state.h"
#include "postproc/machine/machine.h"
#include "postproc/machine/models/controller_models.h"

namespace batten::postproc {

// Seconds from rest to rest. `path` says whether the control blends or keeps the exact path.
// Pieces without length take no time. Linear cost.
//
// Throws std::invalid_argument when a limit of the machine that its model needs is not
// above 0, or a feed is negative or not a number.
[[nodiscard]] double cutting_time(std::span<const TimedPiece> pieces, const Machine& machine,
                                  gcode::PathMode path, ChainEnd end = ChainEnd::kStop);

// The time of one chain of pieces under several settings of its control: what they have in common
// is done once.
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

// The pieces that have a length, each with a feed above 0. Throws as cutting_time does.
[[nodiscard]] std::vector<TimedPiece> with_length_and_feed(std::span<const TimedPiece> pieces,
                                                           const Machine& machine);

// The chain as the machine's model has it. Throws as cutting_time does.
[[nodiscard]] StretchChain stretches_of(std::span<const TimedPiece> pieces, const Machine& machine,
                                        gcode::PathMode path, ChainEnd end, WithPositions places);

}  // namespace batten::postproc
