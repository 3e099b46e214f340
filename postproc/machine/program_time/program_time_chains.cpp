#include "postproc/machine/program_time/program_time_chains.h"

#include <algorithm>
#include <utility>

#include "geometry/basic/rounding.h"

namespace batten::postproc {
namespace {

bool is_motion(StepKind kind) { return kind == StepKind::kCut || kind == StepKind::kRapid; }

// grbl runs rapids and feeds through one queue; others come to rest between the two.
bool rests_between_rapids_and_cuts(const Machine& machine) {
  return machine.model != ControllerModel::kGrbl;
}

class ChainCutter {
 public:
  ChainCutter(const gcode::Program& program, const ProgramSteps& steps, const Machine& machine,
              const std::function<void(const RunChain&)>& use)
      : program_(program), steps_(steps), machine_(machine), base_(machine), use_(use) {}

  void run() {
    for (std::size_t i = 0; i < steps_.steps.size(); ++i) {
      const ProgramStep& step = steps_.steps[i];
      if (!is_motion(step.kind)) {
        close(ChainEnd::kEndOfMotion);
        add_wait(step, static_cast<std::uint32_t>(i));
      } else {
        add_motion(step, static_cast<std::uint32_t>(i));
      }
    }
    close(ChainEnd::kEndOfMotion);
  }

 private:
  void add_wait(const ProgramStep& step, std::uint32_t index) {
    RunChain wait;
    wait.wait = step.kind;
    wait.seconds = seconds_of(step);
    wait.steps.push_back(index);
    use_(wait);
  }

  [[nodiscard]] double seconds_of(const ProgramStep& step) const {
    switch (step.kind) {
      case StepKind::kToolChange:
        return base_.tool_change_time;
      case StepKind::kSpindle:
        return base_.spindle_start_time;
      case StepKind::kDwell:
        return step.seconds + base_.extra_dwell_time;
      default:
        return step.seconds;
    }
  }

  void add_motion(const ProgramStep& step, std::uint32_t index) {
    if (geometry::length_of(step.piece) <= geometry::kSamePlace) return;
    const bool rapid = step.kind == StepKind::kRapid;
    if (!chain_.pieces.empty()) {
      const bool class_changes = chain_.pieces.back().rapid != rapid;
      if (class_changes && rests_between_rapids_and_cuts(machine_)) close(ChainEnd::kStop);
      if (step.control != control_) close(ChainEnd::kStop);
    }
    control_ = step.control;
    chain_.pieces.push_back({step.piece, step.feed, rapid, bytes_up_to(step.block)});
    chain_.steps.push_back(index);
    if (step.stops_after) close(ChainEnd::kStop);
  }

  // Bytes of the block and of those before it that made no motion: the line sends them too.
  int bytes_up_to(std::uint32_t block) {
    const std::uint32_t end = program_.blocks[block].end;
    return static_cast<int>(end - std::exchange(sent_, std::max(sent_, end)));
  }

  void close(ChainEnd end) {
    if (chain_.pieces.empty()) return;
    const PathControl& control = steps_.controls[control_];
    machine_.blend_tolerance = control.blend_tolerance.value_or(base_.blend_tolerance);
    machine_.naive_cam_tolerance = control.naive_cam_tolerance.value_or(base_.naive_cam_tolerance);
    chain_.pieces = with_length_and_feed(chain_.pieces, machine_);
    const auto mode = control.mode == gcode::PathMode::kUnknown ? base_.path_mode : control.mode;
    chain_.stretches = stretches_of(chain_.pieces, machine_, mode, end, WithPositions::kYes);
    use_(chain_);
    chain_ = RunChain{};
  }

  const gcode::Program& program_;
  const ProgramSteps& steps_;
  Machine machine_;  // with the tolerances that hold for the chain
  const Machine& base_;
  const std::function<void(const RunChain&)>& use_;
  RunChain chain_;
  std::uint16_t control_ = 0;
  std::uint32_t sent_ = 0;  // bytes of the program that are counted
};

}  // namespace

void for_each_chain(const gcode::Program& program, const ProgramSteps& steps,
                    const Machine& machine, const std::function<void(const RunChain&)>& use) {
  ChainCutter(program, steps, machine, use).run();
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
  return with_jerk_ ? with_jerk_->time_below(velocity, start_of(i), end_of(i))
                    : motion_of(i).time_below(velocity);
}

}  // namespace batten::postproc
