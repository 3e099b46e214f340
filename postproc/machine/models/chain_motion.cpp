#include "postproc/machine/models/chain_motion.h"

#include <algorithm>

namespace batten::postproc {

ChainMotion::ChainMotion(const StretchChain& chain)
    : chain_(chain), velocities_(joint_velocities(chain.stretches, chain.rules)) {
  const auto& stretches = chain.stretches;
  ends_.reserve(stretches.size());
  if (!has_jerk_limit(stretches)) {
    double end = 0;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
      end += stretch_time(stretches[i], velocities_[i], velocities_[i + 1], chain.rules);
      ends_.push_back(end);
    }
    return;
  }
  with_jerk_ = std::make_unique<const JerkMotion>(stretches, velocities_, chain.rules);
  double way = 0;
  for (const VelocityStretch& s : stretches) {
    ways_.push_back(way);
    way += s.length;
    ends_.push_back(with_jerk_->time_at(way));
  }
  if (!ends_.empty()) ends_.back() = with_jerk_->duration();
}

StretchMotion ChainMotion::motion_of(std::size_t i) const {
  return {chain_.stretches[i], velocities_[i], velocities_[i + 1], chain_.rules};
}

double ChainMotion::share_at(std::size_t i, double time) const {
  const double length = chain_.stretches[i].length;
  const double way =
      with_jerk_ ? with_jerk_->way_at(time) - ways_[i] : motion_of(i).way_at(time - start_of(i));
  return std::clamp(way / length, 0.0, 1.0);
}

double ChainMotion::time_below(std::size_t i, double velocity) const {
  return with_jerk_ ? with_jerk_->time_below(velocity, start_of(i), end_of(i))
                    : motion_of(i).time_below(velocity);
}

}  // namespace batten::postproc
