#include "postproc/stream/prescan.h"

#include <oneapi/tbb/parallel_pipeline.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <deque>
#include <memory>
#include <optional>
#include <utility>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/reason.h"
#include "postproc/convert/conversion.h"
#include "postproc/machine/program_time/program_time_steps.h"
#include "postproc/profile/target_profile.h"
#include "postproc/proof/program_events.h"
#include "postproc/smooth/forms/provenance.h"
#include "postproc/stream/smooth_result.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {

namespace {

// Blocks that are held at once: much more than what a part costs by itself, and much less than a
// window, which is read again from the begin of a part on.
constexpr std::size_t kBlocksAtOnce = 4096;

class PrescanWork {
 public:
  PrescanWork(const gcode::SourceText& source, const SmoothOptions& options,
              const WindowLimits& limits, const ProgressCallback& tell)
      : source_(source),
        target_(*options.target),
        texts_(source, {options.source, reading_of(options, gcode::Language::kRs274)},
               {.blocks = kBlocksAtOnce}),
        meanings_(read_options_of(options)),
        least_blocks_(limits.least_blocks),
        cuts_(asked_of(limits.long_runs, options), grouping_of(options)),
        tell_(tell),
        threads_(threads_at_once(options.threads)) {}

  PrescanReport run() {
    oneapi::tbb::task_arena(threads_).execute([&] { go_through(threads_); });
    if (!ended_early_) finish();
    return std::move(report_);
  }

 private:
  using Part = std::shared_ptr<PartOfText>;

  // Each of the three stages takes about as long as the others.
  void go_through(int threads) {
    using oneapi::tbb::filter_mode;
    using oneapi::tbb::make_filter;
    constexpr std::size_t kStages = 3;
    const auto read = [this](oneapi::tbb::flow_control& flow) -> Part {
      Part part = ended_early_ ? nullptr : texts_.next();
      if (!part) flow.stop();
      if (part && !part->needs_whole)
        part->needs_whole = target_takes_otherwise(part->read.program);
      return part;
    };
    const auto interpret = [this](const Part& part) {
      if (part->needs_whole || ended_early_) return part;
      meanings_.add_to(*part);
      part->begin.before.events = events_;
      events_ = events_before_next({&part->read.program, &part->read.meaning, events_});
      return part;
    };
    const auto look = [this](const Part& part) {
      if (!ended_early_) ended_early_ = !take(*part);
    };
    oneapi::tbb::parallel_pipeline(
        threads > 1 ? 2 * kStages : 1,
        make_filter<void, Part>(filter_mode::serial_in_order, read) &
            make_filter<Part, Part>(filter_mode::serial_in_order, interpret) &
            make_filter<Part, void>(filter_mode::serial_in_order, look));
  }

  [[nodiscard]] bool target_takes_otherwise(const gcode::Program& part) const {
    gcode::Diagnostics others;
    tell_of_other_meanings(part, target_, others);
    tell_of_other_family(part, target_, others);
    return !others.empty();
  }

  // False: the report says why it ends here.
  [[nodiscard]] bool take(const PartOfText& part) {
    if (part.needs_whole) return false;
    starts_.push_back(part.begin);
    look_for_ends(part.read.program, part.read.meaning);
    take_facts(part.read.program, part.read.meaning);
    source_.release_pages({part.begin.text.begin, part.end});
    const bool goes_on = tell_(part.end / static_cast<double>(source_.text().size()));
    if (!goes_on) report_.outcome = PrescanOutcome::kStopped;
    return goes_on;
  }

  void look_for_ends(const gcode::Program& part, const gcode::Interpretation& meaning) {
    const ReadProgram read{&part, &meaning};
    cuts_.begin_part(part, meaning);
    for (std::uint32_t i = 0; i < part.blocks.size(); ++i) {
      cuts_.take(i);
      take_cuts();
      look_behind_rapids(read, i);
    }
  }

  void look_behind_rapids(const ReadProgram& read, std::uint32_t i) {
    const gcode::BlockMeaning& block = read.interpretation->blocks[i];
    const gcode::Block& line = read.program->blocks[i];
    const bool says_nothing = block.barrier.empty() && block.motion < 0;
    const bool is_rapid = block.barrier == gcode::reason::kRapid;
    if (says_nothing ? end_.has_value() : is_rapid && is_plain_rapid(read, i)) {
      end_ = {line.line + 1, line.end};
      return;
    }
    if (end_ && !says_nothing && !is_rapid && line.line >= first_line_ + least_blocks_) {
      end_window(*end_, line.line, false);
    }
    end_.reset();
  }

  void take_cuts() {
    for (const LongRunCut& cut : cuts_.found()) end_window(cut, cut.line, true);
  }

  // `next`: the first block after it. The next window has its blocks counted from `from_line` on.
  void end_window(const LongRunCut& next, std::uint32_t from_line, bool in_run) {
    add_window(next.begin, in_run);
    // What is cut before a window is read with it, and so is what is before that in its part.
    const std::uint32_t needed = in_run ? kNeighbourBlocks : 0;
    while (starts_.size() > 1 && starts_[1].text.blocks + needed < next.line) starts_.pop_front();
    first_line_ = from_line;
  }

  void add_window(std::uint32_t end, bool in_run) {
    const WindowPlace before = report_.windows.empty() ? WindowPlace{} : report_.windows.back();
    report_.windows.push_back({starts_.front(), before.end, end, before.ends_in_run, in_run});
  }

  void take_facts(const gcode::Program& part, const gcode::Interpretation& meaning) {
    report_.blocks += part.blocks.size();
    if (report_.units == gcode::Units::kUnknown) report_.units = first_units(meaning);
    report_.was_smoothed = report_.was_smoothed || was_smoothed(part);
    report_.has_m6 = report_.has_m6 || has_m6(part);
  }

  void finish() {
    cuts_.end_run();
    take_cuts();
    report_.near = cuts_.self_proximity();
    report_.found = texts_.finish();
    const gcode::Diagnostics of_meaning = meanings_.finish();
    report_.found.insert(report_.found.end(), of_meaning.begin(), of_meaning.end());
    if (gcode::has_error(report_.found) || report_.windows.empty()) return;
    add_window(texts_.end(), false);
    for (WindowPlace& window : report_.windows) window.from.before.control.lathe.settle();
    report_.outcome = PrescanOutcome::kWindows;
  }

  const gcode::SourceText& source_;
  const gcode::Control& target_;
  PartTexts texts_;
  PartMeanings meanings_;
  EventsBefore events_;  // behind the last part that was interpreted
  std::size_t least_blocks_;
  LongRunCuts cuts_;
  const ProgressCallback& tell_;
  int threads_;
  std::atomic<bool> ended_early_ = false;
  std::deque<ReadingPlace> starts_;  // of parts, from that on where the next window is read from
  std::optional<LongRunCut> end_;  // where a window may end, if the next block that says something
                                   // is none of the rapids before it
  std::uint32_t first_line_ = 1;   // of the next window
  PrescanReport report_;
};

}  // namespace

PrescanReport prescan(const gcode::SourceText& source, const SmoothOptions& options,
                      const WindowLimits& limits, const ProgressCallback& tell) {
  return PrescanWork(source, options, limits, tell).run();
}

}  // namespace batten::postproc
