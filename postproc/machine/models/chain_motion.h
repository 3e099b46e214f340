// A chain of stretches in time, whatever limits its control keeps.
#pragma once

#include <memory>
#include <vector>

#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/jerk_motion.h"
#include "postproc/machine/models/velocity_profile.h"

namespace batten::postproc {

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
