#include "postproc/program_scout.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <string_view>
#include <utility>

#include "gcode/reason.h"
#include "gcode/source_kind.h"
#include "postproc/profile/target_words.h"
#include "postproc/proof/program_events.h"
#include "postproc/runs/run_joints.h"
#include "postproc/translation/conversion.h"
#include "postproc/writing/provenance.h"

namespace batten::postproc {

namespace {

// Blocks that are held at once: much more than what a part costs by itself, and much less than a
// window, which is read again from the begin of a part on.
constexpr std::size_t kBlocksAtOnce = 4096;

// Bytes of a part, but for the rest of its last line. Without a bound, a search for a kind of line
// end that the text does not have would go through all of it, part for part.
constexpr std::size_t kBytesAtOnce = std::size_t{1} << 19;
constexpr std::size_t kLongestRest = std::size_t{1} << 20;

LongRunLimits limits_of(LongRunLimits limits, const SmoothOptions& options) {
  limits.rewritten = options.method != Method::kNone;
  return limits;
}

class Scout {
 public:
  Scout(const gcode::SourceText& source, const SmoothOptions& options, const WindowLimits& limits,
        const Tell& tell)
      : source_(source),
        options_(options),
        least_blocks_(limits.least_blocks),
        cuts_(limits_of(limits.long_runs, options), grouping_of(options)),
        tell_(tell),
        now_{{}, {gcode::ControlCarry(options.units)}} {
    now_.text.decimals = {reading_of(options, gcode::Language::kRs274).decimals, options.units};
    read_options_ = read_options_of(options);
  }

  ScoutReport run() {
    const auto size = static_cast<double>(source_.text().size());
    while (now_.text.begin < source_.text().size()) {
      const std::uint32_t begin = now_.text.begin;
      const auto end = end_of_part();
      if (!end) return std::move(report_);
      starts_.push_back(now_);
      gcode::Program part =
          gcode::parse_part(source_, {.byte = *end, .blocks = kBlocksAtOnce}, now_.text, of_text_);
      part.dwells = gcode::dwells_of(options_.source);
      const gcode::Interpretation meaning =
          gcode::interpret_part(part, read_options_, now_.before.control, of_meaning_);
      if (needs_whole(part, meaning)) return std::move(report_);
      now_.before.events = events_before_next({&part, &meaning, now_.before.events});
      look_for_ends(part, meaning);
      take_facts(part, meaning);
      source_.set_aside({begin, now_.text.begin});
      if (!tell_(now_.text.begin / size)) {
        report_.outcome = Scouting::kStopped;
        return std::move(report_);
      }
    }
    finish();
    return std::move(report_);
  }

 private:
  // Behind a line feed; nothing where lines are too long or have none.
  [[nodiscard]] std::optional<std::uint32_t> end_of_part() const {
    const std::string_view text = source_.text();
    const std::uint32_t begin = now_.text.begin;
    if (text.size() - begin <= kBytesAtOnce) return static_cast<std::uint32_t>(text.size());
    const std::size_t from = begin + kBytesAtOnce;
    const std::size_t feed = text.substr(from, kLongestRest).find('\n');
    if (feed == std::string_view::npos) return std::nullopt;
    return static_cast<std::uint32_t>(from + feed + 1);
  }

  [[nodiscard]] bool needs_whole(const gcode::Program& part, const gcode::Interpretation& meaning) {
    if (now_.before.control.reaches_out || !now_.text.marks.closes_nothing()) return true;
    gcode::Diagnostics others;
    tell_of_other_meanings(part, *options_.target, others);
    gcode::tell_of_contradictions(part, options_.source, others);
    if (!others.empty() || is_of_another_family(part, *options_.target)) return true;
    if (gcode::has_error(of_text_) || gcode::has_error(of_meaning_)) return true;
    // A curve may go on in the next part.
    return read_options_.curves != nullptr &&
           std::ranges::any_of(meaning.blocks, [](const gcode::BlockMeaning& block) {
             return block.of_curve || block.barrier == gcode::reason::kSpline;
           });
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
    if (says_nothing) {
      if (end_) end_ = {line.line + 1, line.end};
    } else if (block.barrier != gcode::reason::kRapid) {
      if (end_ && line.line >= first_line_ + least_blocks_) end_window(*end_, line.line, false);
      end_.reset();
    } else if (is_plain_rapid(read, i)) {
      end_ = {line.line + 1, line.end};
    } else {
      end_.reset();
    }
  }

  void take_cuts() {
    for (const LongRunCut& cut : cuts_.found()) end_window(cut, cut.line, true);
  }

  // `next`: the first block behind it. The next window has its blocks counted from `from_line` on.
  void end_window(const LongRunCut& next, std::uint32_t from_line, bool in_run) {
    add_window(next.begin, in_run);
    // What is cut before a window is read with it, and so is what stands before that in its part.
    const std::uint32_t needed = in_run ? kNeighbourBlocks : 0;
    while (starts_.size() > 1 && starts_[1].text.blocks + needed < next.line) starts_.pop_front();
    first_line_ = from_line;
  }

  void add_window(std::uint32_t end, bool in_run) {
    WindowPlace window;
    window.from = starts_.front();
    window.begin = report_.windows.empty() ? 0 : report_.windows.back().end;
    window.begins_in_run = !report_.windows.empty() && report_.windows.back().ends_in_run;
    window.end = end;
    window.ends_in_run = in_run;
    report_.windows.push_back(std::move(window));
  }

  void take_facts(const gcode::Program& part, const gcode::Interpretation& meaning) {
    report_.blocks += part.blocks.size();
    for (const gcode::ModalState& state : meaning.states) {
      if (report_.units == gcode::Units::kUnknown) report_.units = state.units;
    }
    report_.was_smoothed = report_.was_smoothed || was_smoothed(part);
  }

  void finish() {
    cuts_.end();
    take_cuts();
    report_.near = cuts_.near_parts();
    gcode::finish_text(now_.text, of_text_);
    gcode::finish_interpretation(now_.before.control, of_meaning_);
    report_.found = std::move(of_text_);
    report_.found.insert(report_.found.end(), of_meaning_.begin(), of_meaning_.end());
    if (gcode::has_error(report_.found) || report_.windows.empty()) return;
    add_window(now_.text.begin, false);
    report_.outcome = Scouting::kWindows;
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  std::size_t least_blocks_;
  LongRunCuts cuts_;
  const Tell& tell_;
  gcode::ReadOptions read_options_;
  ReadingPlace now_;
  std::deque<ReadingPlace> starts_;  // of parts, from that on where the next window is read from
  gcode::Diagnostics of_text_;
  gcode::Diagnostics of_meaning_;
  std::optional<LongRunCut> end_;  // where a window may end, if the next block that says something
                                   // is none of the rapids before it
  std::uint32_t first_line_ = 1;   // of the next window
  ScoutReport report_;
};

}  // namespace

ScoutReport scout(const gcode::SourceText& source, const SmoothOptions& options,
                  const WindowLimits& limits, const Tell& tell) {
  return Scout(source, options, limits, tell).run();
}

}  // namespace batten::postproc
