#include "postproc/machine/program_time/program_time.h"

#include <algorithm>
#include <array>
#include <deque>
#include <functional>
#include <utility>

#include "postproc/machine/machine.h"
#include "postproc/machine/program_time/program_time_chains.h"

namespace batten::postproc {
namespace {

// Below this share of its programmed feed a block counts as slow.
constexpr double kSlowShare = 0.5;

// So many blocks at speed end a slow place: short pauses do not make two places of one corner
// pattern.
constexpr int kBlocksAtSpeed = 5;

// Slow places beyond these are not worth a look.
constexpr std::size_t kMostSlowPlaces = 50;

// Where a step counts, in the order of StepKind.
struct KindRow {
  double TimeParts::*seconds;
  std::size_t StepCounts::*count;
};
constexpr std::array<KindRow, 7> kKinds = {{{&TimeParts::cutting, &StepCounts::cuts},
                                            {&TimeParts::rapids, &StepCounts::rapids},
                                            {&TimeParts::dwells, &StepCounts::dwells},
                                            {&TimeParts::tool_changes, &StepCounts::tool_changes},
                                            {&TimeParts::spindle, &StepCounts::spindle_starts},
                                            {&TimeParts::rotary, nullptr},
                                            {&TimeParts::dwells, nullptr}}};

ToolTime& tool_of(std::vector<ToolTime>& tools, std::int32_t number) {
  const auto known = std::ranges::find(tools, number, &ToolTime::tool);
  if (known != tools.end()) return *known;
  tools.push_back({number, {}});
  return tools.back();
}

// Collects the blocks that run slowly into places.
class SlowPlaces {
 public:
  void add_cut(std::uint32_t line, double seconds, double length, double feed) {
    const double at_feed = length / feed * kMinute;
    if (seconds * kSlowShare <= at_feed) {
      if (++at_speed_ > kBlocksAtSpeed) close();
      return;
    }
    at_speed_ = 0;
    if (!open_) place_ = {.first_line = line};
    open_ = true;
    place_.last_line = line;
    place_.seconds += seconds;
    place_.length_mm += length;
    place_.seconds_lost += seconds - at_feed;
    at_feed_ += at_feed;
  }

  void close() {
    if (!open_) return;
    place_.feed = place_.length_mm / at_feed_ * kMinute;
    places_.push_back(place_);
    open_ = false;
    at_feed_ = 0;
  }

  std::vector<SlowPlace> finish() {
    close();
    std::ranges::stable_sort(places_, std::ranges::greater{}, &SlowPlace::seconds_lost);
    places_.resize(std::min(places_.size(), kMostSlowPlaces));
    return std::move(places_);
  }

 private:
  std::vector<SlowPlace> places_;
  SlowPlace place_;
  double at_feed_ = 0;  // s of the open place at its programmed feeds
  int at_speed_ = 0;
  bool open_ = false;
};

// Seconds of each step, and of each the part below half its feed, as far as its chain is known.
class StepTimes {
 public:
  StepTimes(const Machine& machine, FeedPlanner planner)
      : cutter_(machine, ChainCutter::kMostPieces), machine_(machine), planner_(planner) {}

  void add(const ProgramSteps& steps) {
    const auto use = [this](const RunChain& chain) { take(chain); };
    for (const ProgramStep& step : steps.steps) {
      open_.push_back({step, 0});
      cutter_.add(step, steps.controls, use);
    }
  }

  ProgramTime finish(const NotTimedList& not_timed) {
    cutter_.finish([this](const RunChain& chain) { take(chain); });
    count_up_to(first_open_ + open_.size());
    result_.not_timed = not_timed.entries();
    result_.slowest = slow_.finish();
    return std::move(result_);
  }

 private:
  struct OpenStep {
    ProgramStep step;
    double seconds = 0;
  };

  void take(const RunChain& chain) {
    if (chain.pieces.empty()) {
      open_[chain.steps.front() - first_open_].seconds += chain.seconds;
      return count_up_to(chain.steps.front() + 1);
    }
    if (const auto plan = plan_of(chain, planner_)) {
      add_plan(chain, *plan);
    } else {
      const ChainMotion motion(chain.stretches);
      for (std::size_t i = 0; i < chain.stretches.places.size(); ++i) add_stretch(chain, motion, i);
    }
    count_up_to(chain.steps[chain.end_counted - 1] + 1);
  }

  void add_plan(const RunChain& chain, const ChainPlan& plan) {
    const std::vector<PlannedPiece> planned =
        planned_chain(chain.pieces, machine_, plan.planner, chain.path, plan.density);
    for (std::uint32_t piece = chain.first_counted; piece < chain.end_counted; ++piece) {
      OpenStep& open = open_[chain.steps[piece] - first_open_];
      open.seconds += planned[piece].seconds;
      if (open.step.kind == StepKind::kCut && open.step.feed > 0) {
        result_.below_half_feed += planned[piece].slow_seconds;
      }
    }
  }

  void add_stretch(const RunChain& chain, const ChainMotion& motion, std::size_t i) {
    const StretchPlace& place = chain.stretches.places[i];
    const double duration = motion.end_of(i) - motion.start_of(i);
    const auto add = [&](std::uint32_t piece, double part) {
      if (chain.counts(piece)) open_[chain.steps[piece] - first_open_].seconds += part;
    };
    if (chain.counts(place.first_piece)) {
      const ProgramStep& step = open_[chain.steps[place.first_piece] - first_open_].step;
      const double feed = step.feed;
      if (step.kind == StepKind::kCut && feed > 0)
        result_.below_half_feed += motion.time_below(i, kSlowShare * feed / kMinute);
    }
    if (place.first_piece == place.last_piece) return add(place.first_piece, duration);
    if (place.is_corner) {
      add(place.first_piece, duration / 2);
      return add(place.last_piece, duration / 2);
    }
    const double length = chain.length_of(place);
    for (auto p = place.first_piece; p <= place.last_piece; ++p) {
      add(p, duration * (geometry::length_of(chain.pieces[p].piece) / length));
    }
  }

  void count_up_to(std::size_t end) {
    for (; first_open_ < end; ++first_open_, open_.pop_front()) count(open_.front());
  }

  void count(const OpenStep& done) {
    const auto& [step, seconds] = done;
    const KindRow& kind = kKinds[static_cast<std::size_t>(step.kind)];
    result_.seconds.*kind.seconds += seconds;
    tool_of(result_.tools, step.tool).seconds.*kind.seconds += seconds;
    if (kind.count != nullptr) ++(result_.counts.*kind.count);
    if (step.kind == StepKind::kRapid) result_.rapid_mm += geometry::length_of(step.piece);
    if (step.kind != StepKind::kCut) {
      if (step.kind != StepKind::kRest) slow_.close();
      return;
    }
    const double length = geometry::length_of(step.piece);
    result_.cutting_mm += length;
    if (step.feed > 0 && length > 0) {
      result_.cutting_at_feed += length / step.feed * kMinute;
      slow_.add_cut(step.line, seconds, length, step.feed);
    } else {
      result_.cutting_at_feed += seconds;
    }
  }

  ChainCutter cutter_;
  Machine machine_;
  FeedPlanner planner_;
  std::deque<OpenStep> open_;  // whose chain is not at its end
  std::size_t first_open_ = 0;
  SlowPlaces slow_;
  ProgramTime result_;
};

}  // namespace

struct ProgramTimer::Work {
  StepReader read;
  StepTimes times;
  NotTimedList not_timed = {};
};

ProgramTimer::ProgramTimer(const Machine& machine, const StepOptions& options, FeedPlanner planner)
    : work_(new Work{step_reader(options), StepTimes(machine, planner)}) {}
ProgramTimer::ProgramTimer(const ProgramTimer& other)
    : work_(std::make_unique<Work>(*other.work_)) {}
ProgramTimer::~ProgramTimer() = default;

void ProgramTimer::add(const gcode::Program& part, const gcode::Interpretation& meaning) {
  constexpr std::size_t kBlocksAtOnce = 1024;
  for (std::size_t i = 0; i < part.blocks.size(); i += kBlocksAtOnce) {
    const std::size_t end = std::min(part.blocks.size(), i + kBlocksAtOnce);
    const ProgramSteps& steps = work_->read(part, meaning, i, end);
    work_->times.add(steps);
    work_->not_timed = steps.not_timed;
  }
}

ProgramTime ProgramTimer::finish() { return work_->times.finish(work_->not_timed); }

ProgramTime time_program(const gcode::Program& program, const gcode::Interpretation& meaning,
                         const Machine& machine, const StepOptions& options, FeedPlanner planner) {
  ProgramTimer timer(machine, options, planner);
  timer.add(program, meaning);
  return timer.finish();
}

}  // namespace batten::postproc
