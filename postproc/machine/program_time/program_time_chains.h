// The steps of a program cut where its motion comes to rest, as a machine's control runs them.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/velocity_profile.h"
#include "postproc/machine/program_time/program_time_steps.h"

namespace batten::postproc {

// Motions from rest to rest, or one wait.
struct RunChain {
  StepKind wait = StepKind::kRest;   // meaningful where there are no pieces
  double seconds = 0;                // of the wait
  std::vector<TimedPiece> pieces;    // each with a length and a feed
  std::vector<std::uint32_t> steps;  // the step of each piece; of a wait its own
  StretchChain stretches;            // with places
};

// Calls `use` for each chain in the order of the program. The memory it needs is that of the
// longest chain. Times of tool changes and of the spindle are the machine's.
void for_each_chain(const gcode::Program& program, const ProgramSteps& steps,
                    const Machine& machine, const std::function<void(const RunChain&)>& use);

// A chain of stretches in time, whatever limits its control keeps.

// From rest to rest; its duration is profile_time of the chain.
class ChainMotion {
 public:
  // Keeps a reference to `chain`.
  explicit ChainMotion(const StretchChain& chain);

  [[nodiscard]] double duration() const { return ends_.empty() ? 0 : ends_.back(); }

  // When stretch i begins and ends, s; the rest after a stop is part of the stretch.
  [[nodiscard]] double start_of(std::size_t i) const { return i == 0 ? 0 : ends_[i - 1]; }
  [[nodiscard]] double end_of(std::size_t i) const { return ends_[i]; }

  // The share, from 0 to 1, of the stretch's way at a time within it.
  [[nodiscard]] double share_at(std::size_t i, double time) const;

  // Seconds of the stretch at less than this speed (mm/s).
  [[nodiscard]] double time_below(std::size_t i, double velocity) const;

 private:
  [[nodiscard]] StretchMotion motion_of(std::size_t i) const;

  const StretchChain& chain_;
  std::vector<double> velocities_;
  std::vector<double> ends_;
  // With a limit on jerk only: the whole chain, and the way before each stretch (mm).
  std::unique_ptr<const JerkMotion> with_jerk_;
  std::vector<double> ways_;
};

}  // namespace batten::postproc
