// The predicted speed along the cutting moves of one program.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {

// Every chain of cutting moves between two events is run from rest to rest, as the model of the
// machine's control does it. Linear cost.
class ProgramSpeeds {
 public:
  ProgramSpeeds(const ReadProgram& read, const ProgramEvents& events, const Machine& machine);

  // mm/min; `share` of the motion's length, 0 to 1. 0 for motions that are in no chain.
  [[nodiscard]] double at(std::uint32_t motion, double share) const;

 private:
  struct Sample {
    double way = 0;    // mm from the start of the chain, along the programmed path
    double speed = 0;  // mm/s
  };
  struct Place {
    std::size_t chain = 0;
    double way = 0;  // mm from the start of the chain, along the programmed path
    double length = 0;
  };

  void add_chain(const ReadProgram& read, const Cut* begin, const Cut* end, const Machine& machine);

  std::vector<std::vector<Sample>> chains_;
  std::vector<Place> places_;  // one per motion; no length: in no chain
};

}  // namespace batten::postproc
