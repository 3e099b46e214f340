#include "postproc/program_scout.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "gcode/part_reading.h"
#include "gcode/reason.h"
#include "gcode/source_kind.h"
#include "postproc/profile/target_words.h"
#include "postproc/proof/program_events.h"
#include "postproc/translation/conversion.h"
#include "postproc/writing/provenance.h"

namespace batten::postproc {

namespace {

// Blocks that are held at once: some megabytes, and much more than what a part costs by itself.
constexpr std::size_t kBlocksAtOnce = 16384;

// Bytes of a part, but for the rest of its last line. Without a bound, a search for a kind of line
// end that the text does not have would go through all of it, part for part.
constexpr std::size_t kBytesAtOnce = std::size_t{1} << 19;
constexpr std::size_t kLongestRest = std::size_t{1} << 20;

class Scout {
 public:
  Scout(const gcode::SourceText& source, const SmoothOptions& options, std::size_t least_blocks,
        const Tell& tell)
      : source_(source),
        options_(options),
        least_blocks_(least_blocks),
        tell_(tell),
        control_(options.units) {
    text_.decimals = {reading_of(options, gcode::Language::kRs274).decimals, options.units};
    read_options_.units = options.units;
    read_options_.curves = options.target->curves();
  }

  ScoutReport run() {
    const auto size = static_cast<double>(source_.text().size());
    while (text_.begin < source_.text().size()) {
      const std::uint32_t begin = text_.begin;
      const auto end = end_of_part();
      if (!end) return std::move(report_);
      const gcode::Program part =
          gcode::parse_part(source_, {.byte = *end, .blocks = kBlocksAtOnce}, text_, of_text_);
      const gcode::Interpretation meaning =
          gcode::interpret_part(part, read_options_, control_, of_meaning_);
      if (needs_whole(part, meaning)) return std::move(report_);
      look_for_ends(part, meaning);
      take_facts(part, meaning);
      source_.set_aside({begin, text_.begin});
      if (!tell_(text_.begin / size)) {
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
    if (text.size() - text_.begin <= kBytesAtOnce) return static_cast<std::uint32_t>(text.size());
    const std::size_t from = text_.begin + kBytesAtOnce;
    const std::size_t feed = text.substr(from, kLongestRest).find('\n');
    if (feed == std::string_view::npos) return std::nullopt;
    return static_cast<std::uint32_t>(from + feed + 1);
  }

  [[nodiscard]] bool needs_whole(const gcode::Program& part, const gcode::Interpretation& meaning) {
    if (control_.reaches_out || !text_.marks.closes_nothing()) return true;
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
    for (std::uint32_t i = 0; i < part.blocks.size(); ++i) {
      const gcode::BlockMeaning& block = meaning.blocks[i];
      const bool says_nothing = block.barrier.empty() && block.motion < 0;
      if (says_nothing) {
        if (end_) end_ = part.blocks[i].end;
      } else if (block.barrier != gcode::reason::kRapid) {
        if (end_ && report_.blocks + i - blocks_in_ends_ >= least_blocks_) {
          report_.ends.push_back(*end_);
          blocks_in_ends_ = report_.blocks + i;
        }
        end_.reset();
      } else if (is_plain_rapid(read, i)) {
        end_ = part.blocks[i].end;
      } else {
        end_.reset();
      }
    }
  }

  void take_facts(const gcode::Program& part, const gcode::Interpretation& meaning) {
    report_.blocks += part.blocks.size();
    for (const gcode::ModalState& state : meaning.states) {
      if (report_.units == gcode::Units::kUnknown) report_.units = state.units;
    }
    report_.was_smoothed = report_.was_smoothed || was_smoothed(part);
  }

  void finish() {
    gcode::finish_text(text_, of_text_);
    gcode::finish_interpretation(control_, of_meaning_);
    report_.found = std::move(of_text_);
    report_.found.insert(report_.found.end(), of_meaning_.begin(), of_meaning_.end());
    if (gcode::has_error(report_.found) || report_.ends.empty()) return;
    report_.ends.push_back(text_.begin);
    report_.outcome = Scouting::kWindows;
  }

  const gcode::SourceText& source_;
  const SmoothOptions& options_;
  std::size_t least_blocks_;
  const Tell& tell_;
  gcode::ReadOptions read_options_;
  gcode::TextCarry text_;
  gcode::ControlCarry control_;
  gcode::Diagnostics of_text_;
  gcode::Diagnostics of_meaning_;
  std::optional<std::uint32_t> end_;  // where a window may end, if the next block that says
                                      // something is none of the rapids before it
  std::size_t blocks_in_ends_ = 0;
  ScoutReport report_;
};

}  // namespace

ScoutReport scout(const gcode::SourceText& source, const SmoothOptions& options,
                  std::size_t least_blocks, const Tell& tell) {
  return Scout(source, options, least_blocks, tell).run();
}

}  // namespace batten::postproc
