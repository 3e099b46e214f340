#include "postproc/machine/program_time/program_time.h"

#include <algorithm>
#include <array>
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

// Seconds of each step of a program, and of each the part below half its feed.
class StepTimes {
 public:
  explicit StepTimes(const std::vector<ProgramStep>& steps)
      : steps_(steps), seconds_(steps.size(), 0.0) {}

  void add(const RunChain& chain) {
    if (chain.pieces.empty()) {
      seconds_[chain.steps.front()] += chain.seconds;
      return;
    }
    const ChainMotion motion(chain.stretches);
    for (std::size_t i = 0; i < chain.stretches.places.size(); ++i) add_stretch(chain, motion, i);
  }

  [[nodiscard]] double seconds(std::size_t step) const { return seconds_[step]; }
  [[nodiscard]] double below_half_feed() const { return below_half_feed_; }

 private:
  void add_stretch(const RunChain& chain, const ChainMotion& motion, std::size_t i) {
    const StretchPlace& place = chain.stretches.places[i];
    const double duration = motion.end_of(i) - motion.start_of(i);
    const ProgramStep& step = steps_[chain.steps[place.first_piece]];
    if (step.feed > 0) {
      below_half_feed_ += motion.time_below(i, kSlowShare * step.feed / kMinute);
    }
    const auto add = [&](std::uint32_t piece, double part) {
      seconds_[chain.steps[piece]] += part;
    };
    if (place.first_piece == place.last_piece) return add(place.first_piece, duration);
    if (place.is_corner) {
      add(place.first_piece, duration / 2);
      return add(place.last_piece, duration / 2);
    }
    double length = 0;
    for (auto p = place.first_piece; p <= place.last_piece; ++p) {
      length += geometry::length_of(chain.pieces[p].piece);
    }
    for (auto p = place.first_piece; p <= place.last_piece; ++p) {
      add(p, duration * (geometry::length_of(chain.pieces[p].piece) / length));
    }
  }

  const std::vector<ProgramStep>& steps_;
  std::vector<double> seconds_;
  double below_half_feed_ = 0;
};

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

}  // namespace

ProgramTime time_program(const gcode::Program& program, const gcode::Interpretation& meaning,
                         const Machine& machine, const StepOptions& options) {
  return time_steps(program, read_steps(program, meaning, options), machine);
}

ProgramTime time_steps(const gcode::Program& program, const ProgramSteps& steps,
                       const Machine& machine) {
  StepTimes times(steps.steps);
  for_each_chain(program, steps, machine, [&](const RunChain& chain) { times.add(chain); });

  ProgramTime result;
  result.not_timed = steps.not_timed.entries();
  result.below_half_feed = times.below_half_feed();
  SlowPlaces slow;
  for (std::size_t i = 0; i < steps.steps.size(); ++i) {
    const ProgramStep& step = steps.steps[i];
    const double seconds = times.seconds(i);
    const KindRow& kind = kKinds[static_cast<std::size_t>(step.kind)];
    result.seconds.*kind.seconds += seconds;
    tool_of(result.tools, step.tool).seconds.*kind.seconds += seconds;
    if (kind.count != nullptr) ++(result.counts.*kind.count);
    if (step.kind == StepKind::kRapid) result.rapid_mm += geometry::length_of(step.piece);
    if (step.kind != StepKind::kCut) {
      if (step.kind != StepKind::kRest) slow.close();
      continue;
    }
    const double length = geometry::length_of(step.piece);
    result.cutting_mm += length;
    if (step.feed > 0 && length > 0) {
      result.cutting_at_feed += length / step.feed * kMinute;
      slow.add_cut(program.blocks[step.block].line, seconds, length, step.feed);
    } else {
      result.cutting_at_feed += seconds;
    }
  }
  result.slowest = slow.finish();
  return result;
}

}  // namespace batten::postproc
