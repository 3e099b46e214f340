#include "postproc/stream/inspect_in_parts.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

#include "gcode/state/reason.h"
#include "postproc/proof/program_events.h"
#include "postproc/runs/run_blocks.h"

namespace batten::postproc {

namespace {

// What a block is to the chain of motions that it may stand in.
enum class InChain {
  kNo,     // it ends there
  kIdle,   // says nothing
  kArc,    // a motion that may be a piece of a curve
  kStill,  // a line of no length
  kAlongZ,
  kLine,  // any other
};

// The blocks that are held, as chains of motions.
class Chains {
 public:
  Chains(const gcode::ReadPart& part, const GroupingOptions& grouping)
      : part_(part), blocks_(part.program, part.meaning), grouping_(grouping) {}

  [[nodiscard]] InChain at(std::uint32_t i) const {
    const gcode::BlockMeaning& block = part_.meaning.blocks[i];
    const bool arc = block.barrier == gcode::reason::kArc && block.motion >= 0;
    if (!block.barrier.empty() && !arc) return InChain::kNo;
    if (block.motion < 0) return InChain::kIdle;
    if (arc) return block.kind == gcode::BlockKind::kMotion ? InChain::kArc : InChain::kNo;
    const gcode::Motion& motion = blocks_.motion(i);
    if (!motion.start_known || is_unsafe(block.state_after)) return InChain::kNo;
    if (motion.kind != gcode::MotionKind::kLine) return InChain::kArc;
    if (!blocks_.moves(i)) return InChain::kStill;
    return blocks_.heading(i) == RunBlocks::Heading::kAlongZ ? InChain::kAlongZ : InChain::kLine;
  }

  // Whether the chain that goes on from block to block has an arc on the way back from `from`.
  [[nodiscard]] bool has_arc_before(std::uint32_t from) const {
    for (std::uint32_t i = from; i > 0; --i) {
      if (const auto arc = answer_at(i - 1)) return *arc;
    }
    return false;
  }
  [[nodiscard]] bool has_arc_from(std::uint32_t from) const {
    for (std::uint32_t i = from; i < part_.program.blocks.size(); ++i) {
      if (const auto arc = answer_at(i)) return *arc;
    }
    return false;
  }

 private:
  // Whether the chain has an arc, as far as this block says so: that it is one, or that the chain
  // ends there. Nearly all blocks are lines in the state of the one before.
  [[nodiscard]] std::optional<bool> answer_at(std::uint32_t i) const {
    const gcode::BlockMeaning& block = part_.meaning.blocks[i];
    if (block.barrier.empty() && block.motion >= 0 && asked_state_ == block.state_after &&
        !unsafe_ && blocks_.motion(i).start_known && !blocks_.arc(i)) {
      return std::nullopt;
    }
    const InChain here = at(i);
    if (here == InChain::kNo) return false;
    return here == InChain::kArc ? std::optional(true) : std::nullopt;
  }

  // States are shared by many blocks: asked once for each.
  [[nodiscard]] bool is_unsafe(std::uint32_t state) const {
    if (asked_state_ != state) {
      asked_state_ = state;
      unsafe_ = !unsafe_state(part_.meaning.states[state], grouping_).empty();
    }
    return unsafe_;
  }

  const gcode::ReadPart& part_;
  RunBlocks blocks_;
  const GroupingOptions& grouping_;
  mutable std::optional<std::uint32_t> asked_state_;
  mutable bool unsafe_ = false;
};

class PartInspector {
 public:
  PartInspector(const gcode::SourceText& source, const PartReading& reading,
                const GroupingOptions& grouping, const InspectLimits& limits)
      : reader_(source, reading, limits.parts),
        grouping_(grouping),
        longest_(limits.longest),
        cut_from_(limits.longest) {}

  std::optional<InspectedProgram> run() {
    auto next = PartReader::Next::kRead;
    while (next == PartReader::Next::kRead) {
      next = reader_.read_on();
      if (next == PartReader::Next::kNeedsWhole) return std::nullopt;
      const auto blocks = static_cast<std::uint32_t>(reader_.blocks_held());
      if (next == PartReader::Next::kAtEnd) {
        if (!take(blocks, false)) next = PartReader::Next::kRead;
      } else if (const std::uint32_t end = end_behind_rapids()) {
        take(end, false);
      } else if (const std::uint32_t cut = place_in_chain()) {
        take(cut, true);
      }
    }
    auto found = reader_.finish();
    if (!found || !certain_) return std::nullopt;
    return InspectedProgram{inspection_.take(), std::move(*found), reader_.blocks_read(),
                            reader_.unit_word_seen()};
  }

 private:
  // The last block behind plain rapids, and what says nothing behind them, that is none of them;
  // 0: none, but where that was looked for before.
  [[nodiscard]] std::uint32_t end_behind_rapids() {
    const gcode::ReadPart& held = reader_.held();
    const auto& blocks = held.meaning.blocks;
    const auto says_nothing = [&](std::uint32_t i) {
      return blocks[i].barrier.empty() && blocks[i].motion < 0;
    };
    const auto count = static_cast<std::uint32_t>(blocks.size());
    for (std::uint32_t i = count; i > std::max(looked_at_, 1U); --i) {
      const std::uint32_t end = i - 1;
      if (says_nothing(end) || blocks[end].barrier == gcode::reason::kRapid) continue;
      std::uint32_t before = end;
      while (before > 0 && says_nothing(before - 1)) --before;
      if (before > 0 && is_plain_rapid({&held.program, &held.meaning}, before - 1)) return end;
    }
    looked_at_ = count;
    return 0;
  }

  // Where a chain of lines may be cut, near the end of what is held; 0: nowhere.
  [[nodiscard]] std::uint32_t place_in_chain() {
    const auto count = static_cast<std::uint32_t>(reader_.blocks_held());
    if (count < cut_from_) return 0;
    const Chains chains(reader_.held(), grouping_);
    const auto beside = static_cast<std::uint32_t>(std::max<std::size_t>(grouping_.min_motions, 1));
    std::uint32_t lines = 0;  // that follow each other, from `i` on
    constexpr std::uint32_t kFurthest = 4096;
    for (std::uint32_t i = count; i > 0 && count - i < kFurthest; --i) {
      lines = chains.at(i - 1) == InChain::kLine ? lines + 1 : 0;
      if (lines < 2 * beside) continue;
      const std::uint32_t place = i - 1 + beside;
      if (!chains.has_arc_from(place) && !chains.has_arc_before(place)) return place;
      break;
    }
    cut_from_ = std::size_t{2} * count;  // what was looked at is not looked at again part for part
    return 0;
  }

  // Inspects the first blocks that are held. False: the chain of the pieces so far has an arc, and
  // is read again from its begin, to be held as one.
  bool take(std::uint32_t count, bool in_chain) {
    if (!in_chain_ && in_chain) begin_.emplace(Begin{reader_, inspection_.size()});
    const gcode::ReadPart part = reader_.take(count);
    if (in_chain_ && Chains(part, grouping_).has_arc_from(0)) {
      go_back();
      return false;
    }
    const std::vector<Section> sections = group_runs(part.program, part.meaning, grouping_);
    const bool is_run = !sections.empty() && sections.front().first_block == 0 &&
                        std::holds_alternative<Run>(sections.front().content);
    if (in_chain_ && !is_run) certain_ = false;
    inspection_.add(part.program, part.meaning, sections, in_chain_);
    in_chain_ = in_chain;
    if (!in_chain) begin_.reset();
    looked_at_ = 0;
    cut_from_ = longest_;
    return true;
  }

  void go_back() {
    reader_ = std::move(begin_->reader);
    inspection_.go_back_to(begin_->sections);
    begin_.reset();
    in_chain_ = false;
    looked_at_ = 0;
    cut_from_ = static_cast<std::size_t>(-1);
  }

  // Before the part that ends at the first cut of a chain.
  struct Begin {
    PartReader reader;
    std::size_t sections = 0;
  };

  PartReader reader_;
  const GroupingOptions& grouping_;
  std::size_t longest_;
  Inspection inspection_;
  bool in_chain_ = false;        // what is held goes on a chain that was cut
  std::uint32_t looked_at_ = 0;  // blocks that are held behind which no part ends
  std::size_t cut_from_;         // so many blocks are held before a chain is cut
  std::optional<Begin> begin_;
  bool certain_ = true;  // that pieces of a chain are runs: the whole is asked where one is not
};

}  // namespace

std::optional<InspectedProgram> inspect_in_parts(const gcode::SourceText& source,
                                                 const PartReading& reading,
                                                 const GroupingOptions& grouping,
                                                 const InspectLimits& limits) {
  return PartInspector(source, reading, grouping, limits).run();
}

}  // namespace batten::postproc
