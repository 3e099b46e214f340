#include "postproc/machine/program_time/program_time_chains.h"

#include <algorithm>
#include <utility>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

bool is_motion(StepKind kind) { return kind == StepKind::kCut || kind == StepKind::kRapid; }

bool rests_between_rapids_and_cuts(const Machine& machine) { return !has_one_queue(machine.model); }

}  // namespace

double RunChain::length_of(const StretchPlace& place) const {
  double length = 0;
  for (auto p = place.first_piece; p <= place.last_piece; ++p) {
    length += geometry::length_of(pieces[p].piece);
  }
  return length;
}

void ChainCutter::add(const ProgramStep& step, const std::vector<gcode::PathControl>& controls,
                      const Use& use) {
  sent_ += static_cast<int>(step.bytes);
  if (is_motion(step.kind)) {
    add_motion(step, controls, use);
  } else {
    close(ChainEnd::kEndOfMotion, use);
    RunChain wait;
    wait.wait = step.kind;
    wait.seconds = seconds_of(step);
    wait.steps.push_back(steps_);
    use(wait);
  }
  ++steps_;
}

double ChainCutter::seconds_of(const ProgramStep& step) const {
  switch (step.kind) {
    case StepKind::kToolChange:
      return machine_.tool_change_time;
    case StepKind::kSpindle:
      return machine_.spindle_start_time;
    case StepKind::kDwell:
      return step.seconds + machine_.extra_dwell_time;
    default:
      return step.seconds;
  }
}

void ChainCutter::add_motion(const ProgramStep& step,
                             const std::vector<gcode::PathControl>& controls, const Use& use) {
  if (geometry::length_of(step.piece) <= geometry::kSamePlace) return;
  const bool rapid = step.kind == StepKind::kRapid;
  const gcode::PathControl& control = controls[step.control];
  if (!chain_.pieces.empty()) {
    const bool class_changes = chain_.pieces.back().rapid != rapid;
    if (class_changes && rests_between_rapids_and_cuts(machine_)) close(ChainEnd::kStop, use);
    if (control != control_) close(ChainEnd::kStop, use);
  }
  control_ = control;
  // Bytes of blocks before it that made no motion: the line sends them too.
  chain_.pieces.push_back({step.piece, step.feed, rapid, std::exchange(sent_, 0), step.says_speed,
                           step.goes_on, step.arcs});
  chain_.steps.push_back(steps_);
  if (step.stops_after) return close(ChainEnd::kStop, use);
  if (chain_.pieces.size() < most_pieces_) return;
  use_part(ChainEnd::kStop, chain_.pieces.size() - kMargin, use);
  chain_.pieces.erase(chain_.pieces.begin(), chain_.pieces.end() - 2 * std::ptrdiff_t{kMargin});
  chain_.steps.erase(chain_.steps.begin(), chain_.steps.end() - 2 * std::ptrdiff_t{kMargin});
  chain_.first_counted = kMargin;
}

void ChainCutter::close(ChainEnd end, const Use& use) {
  if (chain_.pieces.empty()) return;
  use_part(end, chain_.pieces.size(), use);
  chain_ = RunChain{};
}

void ChainCutter::use_part(ChainEnd end, std::size_t end_counted, const Use& use) {
  chain_.pieces = with_length_and_feed(chain_.pieces, machine_);
  chain_.path = control_;
  if (control_.mode == gcode::PathMode::kUnknown) chain_.path.mode = machine_.path_mode;
  chain_.stretches = stretches_of(chain_.pieces, machine_, chain_.path, end, WithPositions::kYes);
  chain_.end_counted = static_cast<std::uint32_t>(end_counted);
  use(chain_);
  chain_.stretches = StretchChain();
}

std::optional<ChainPlan> plan_of(const RunChain& chain, FeedPlanner asked) {
  if (asked != FeedPlanner::kControl) return ChainPlan{asked};
  const StretchChain& stretches = chain.stretches;
  if (!(stretches.in_slow_curves > 0)) return {};
  if (!takes_a_plan(stretches, profile_time(stretches.stretches, stretches.rules))) return {};
  return ChainPlan{FeedPlanner::kJerk, kQuickPlanDensity};
}

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
  if (with_jerk_) return with_jerk_->time_below(velocity, start_of(i), end_of(i));
  // Between two joints the speed is nowhere below that at the slower one.
  if (velocity > 0 && std::min(velocities_[i], velocities_[i + 1]) >= velocity) return 0;
  return motion_of(i).time_below(velocity);
}

}  // namespace batten::postproc
