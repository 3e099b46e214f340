#include "postproc/stream/inspect.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include "gcode/state/reason.h"
#include "gcode/text/large_pages.h"
#include "geometry/basic/rounding.h"
#include "geometry/path/path.h"
#include "postproc/proof/program_events.h"
#include "postproc/stream/misread_arcs.h"

namespace batten::postproc {

namespace {

using geometry::Vector3;

// In between, the mean of the two middle ones.
double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  if (values.size() % 2 == 1) return *middle;
  return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

// The segments of a run, counted one after the other: of all of it, or of its parts in order.
// Holds a length for each segment, for their median, and nothing else of them.
class SegmentTally {
 public:
  // The run of a section, which starts where the part before it has ended.
  void add(const gcode::ReadPart& read, const Section& section) {
    const Run& run = std::get<Run>(section.content);
    const std::vector<std::uint32_t> blocks = blocks_of_edges(section, read.meaning);
    if (lengths_.empty()) gcode::reserve_in_large_pages(lengths_, run.points.size());
    auto bend = run.bends.begin();
    for (std::size_t i = 0; i + 1 < run.points.size();) {
      const std::uint32_t line = read.program.blocks[blocks[i]].line;
      if (bend != run.bends.end() && bend->first == i) {
        add_segment(geometry::length_of(bend->piece), geometry::direction_at(bend->piece, 0),
                    geometry::direction_at(bend->piece, 1), line);
        i = bend++->last;
      } else {
        const Vector3 along = run.points[i + 1] - run.points[i];
        const double length = along.norm();
        const Vector3 direction = length > 0 ? Vector3(along / length) : Vector3(Vector3::Zero());
        add_segment(length, direction, direction, line);
        ++i;
      }
    }
  }

  // Begins anew.
  [[nodiscard]] SegmentStatistics take() {
    SegmentTally all = std::exchange(*this, {});
    all.found_.count = all.lengths_.size();
    all.found_.greatest_turn_deg = all.turn_.radians * 180 / std::numbers::pi;
    all.found_.turn_line = all.turn_.line;
    if (all.found_.count > 0) all.found_.median = median_of(std::move(all.lengths_));
    return all.found_;
  }

 private:
  struct Turn {
    double radians = 0;
    std::uint32_t line = 0;
    double certainly_less = 0;  // squared sine of turns that are less than the greatest so far
  };

  // Directions are unit vectors, or zero where there is none.
  void add_segment(double length, const Vector3& start, const Vector3& end, std::uint32_t line) {
    look_at_turn(start);
    found_.shortest = lengths_.empty() ? length : std::min(found_.shortest, length);
    found_.longest = std::max(found_.longest, length);
    found_.length += length;
    lengths_.push_back(length);
    before_ = end;
    line_before_ = line;
  }

  void look_at_turn(const Vector3& to) {
    if (before_.isZero() || to.isZero()) return;
    const Vector3 across = before_.cross(to);
    const double along = before_.dot(to);
    if (along > 0 && across.squaredNorm() <= turn_.certainly_less) return;
    // atan2 keeps small turns exact where acos loses half of the digits.
    const double turn = std::atan2(across.norm(), along);
    if (!(turn > turn_.radians)) return;
    // Sines rise up to a right angle. Far above the rounding of unit vectors and of a sine.
    constexpr double kRounding = 1e-9;
    const double sine = std::sin(std::min(turn, std::numbers::pi / 2)) * (1 - kRounding);
    turn_ = {turn, line_before_, sine * sine};
  }

  std::vector<double> lengths_;
  SegmentStatistics found_;
  Turn turn_;
  Vector3 before_ = Vector3::Zero();  // the direction of the last one
  std::uint32_t line_before_ = 0;     // of its block
};

InspectedSection described(const gcode::ReadPart& part, const Section& section) {
  InspectedSection description;
  description.first_line = part.program.blocks[section.first_block].line;
  description.last_line = part.program.blocks[section.last_block].line;
  description.blocks = section.last_block - section.first_block + 1;
  const RunBlocks blocks(part.program, part.meaning);
  for (std::uint32_t block = section.first_block; block <= section.last_block; ++block) {
    if (part.meaning.blocks[block].motion < 0) continue;
    if (blocks.motion(block).kind != gcode::MotionKind::kRapid) ++description.cutting_moves;
  }
  if (const auto* verbatim = std::get_if<Verbatim>(&section.content)) {
    description.reason = verbatim->reason;
  }
  return description;
}

void add_feeds(const Run& run, bool first, InspectedSection& section) {
  if (run.feeds.empty()) return;
  const auto [least, greatest] = std::ranges::minmax(run.feeds, {}, &FeedFrom::feed);
  section.least_feed = first ? least.feed : std::min(section.least_feed, least.feed);
  section.greatest_feed = first ? greatest.feed : std::max(section.greatest_feed, greatest.feed);
}

// The sections so far, and the lengths of the segments of the run that goes on.
class Inspection {
 public:
  explicit Inspection(const GroupingOptions& grouping) : grouping_(grouping) {}

  // The sections of the next blocks. `goes_on`: the last run so far goes on in the first of them,
  // which is a run from its first block on; their lines are those of one chain.
  void add(const gcode::ReadPart& part, const std::vector<Section>& sections, bool goes_on) {
    causes_.add(part.program, part.meaning, sections, grouping_);
    for (const Section& section : sections) {
      const InspectedSection more = described(part, section);
      if (goes_on) {
        sections_.back().blocks += more.blocks;
        sections_.back().cutting_moves += more.cutting_moves;
      } else {
        end_run();
        sections_.push_back(more);
      }
      if (std::holds_alternative<Run>(section.content)) add_run(part, section, !goes_on);
      goes_on = false;
    }
  }

  // How far it is.
  struct Mark {
    std::size_t sections = 0;
    CauseTally causes;
  };
  [[nodiscard]] Mark mark() const { return {sections_.size(), causes_}; }
  // Takes the sections after that away again. None of those that stay goes on.
  void go_back_to(const Mark& mark) {
    in_run_ = false;
    tally_ = {};
    sections_.resize(mark.sections);
    causes_ = mark.causes;
  }

  [[nodiscard]] KeptCauses causes() const { return causes_.causes(); }

  [[nodiscard]] std::vector<InspectedSection> take() {
    end_run();
    return std::move(sections_);
  }

 private:
  void add_run(const gcode::ReadPart& part, const Section& section, bool begins) {
    const Run& run = std::get<Run>(section.content);
    InspectedSection& description = sections_.back();
    if (begins) start_ = run.points.front();
    in_run_ = true;
    tally_.add(part, section);
    add_feeds(run, begins, description);
    description.last_line = part.program.blocks[section.last_block].line;
    description.decimals = std::max(description.decimals, run.decimals);
    description.closed = (run.points.back() - start_).norm() <= geometry::kSamePlace;
  }

  void end_run() {
    if (std::exchange(in_run_, false)) sections_.back().segments = tally_.take();
  }

  const GroupingOptions& grouping_;
  std::vector<InspectedSection> sections_;
  CauseTally causes_;
  // Of the last section, where it is a run that may go on.
  bool in_run_ = false;
  SegmentTally tally_;
  geometry::Point3 start_ = geometry::Point3::Zero();
};

// The blocks that are held, as chains of lines, and of arcs that may be segments of a curve.
class Chains {
 public:
  Chains(const gcode::ReadPart& part, const GroupingOptions& grouping)
      : part_(part), blocks_(part.program, part.meaning), states_(grouping) {
    states_.begin(part.meaning);
  }

  // Whether a chain may be cut beside it: a line that goes neither straight along Z nor nowhere.
  [[nodiscard]] bool is_line(std::uint32_t i) {
    return part_.meaning.blocks[i].motion >= 0 && !ends_chain(i) && !is_arc(i) &&
           blocks_.moves(i) && blocks_.heading(i) != RunBlocks::Heading::kAlongZ;
  }

  // Whether the chain that goes on from block to block has an arc before `from`.
  [[nodiscard]] bool has_arc_before(std::uint32_t from) {
    for (std::uint32_t i = from; i > 0 && !ends_chain(i - 1); --i) {
      if (is_arc(i - 1)) return true;
    }
    return false;
  }
  [[nodiscard]] bool has_arc_from(std::uint32_t from) {
    for (std::uint32_t i = from; i < part_.program.blocks.size() && !ends_chain(i); ++i) {
      if (is_arc(i)) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] bool ends_chain(std::uint32_t i) {
    const gcode::BlockMeaning& block = part_.meaning.blocks[i];
    if (block.motion < 0) return !block.barrier.empty();
    if (block.barrier == gcode::reason::kArc) return block.kind != gcode::BlockKind::kMotion;
    return !block.barrier.empty() || !blocks_.motion(i).start_known ||
           !states_.reason(block.state_after).empty();
  }

  // Of a block that does not end a chain.
  [[nodiscard]] bool is_arc(std::uint32_t i) const {
    return part_.meaning.blocks[i].motion >= 0 &&
           blocks_.motion(i).kind != gcode::MotionKind::kLine;
  }

  const gcode::ReadPart& part_;
  RunBlocks blocks_;
  UnsafeStates states_;
};

class PartInspector {
 public:
  PartInspector(const gcode::SourceText& source, const PartReading& reading,
                const GroupingOptions& grouping, const InspectLimits& limits,
                const gcode::Control* target, bool as_whole)
      : reader_(source, reading, limits.parts, as_whole),
        grouping_(grouping),
        target_(target),
        inspection_(grouping),
        longest_(limits.longest),
        cut_from_(limits.longest) {}

  std::optional<InspectedProgram> run() {
    for (bool at_end = false; !at_end;) {
      const auto next = reader_.read_on();
      if (next == PartReader::Next::kNeedsWhole) return std::nullopt;
      if (next == PartReader::Next::kAtEnd) {
        at_end = take(reader_.blocks_held(), false);
      } else if (const std::uint32_t end = end_after_rapids()) {
        take(end, false);
      } else if (const std::uint32_t cut = cut_in_chain()) {
        take(cut, true);
      }
    }
    auto found = reader_.finish();
    if (!found || !certain_) return std::nullopt;
    std::ranges::move(misread_, std::back_inserter(*found));
    return InspectedProgram{inspection_.take(),    inspection_.causes(),     std::move(*found),
                            reader_.blocks_read(), reader_.unit_word_seen(), reader_.is_whole()};
  }

 private:
  // The last block after plain rapids, and what says nothing after them, that is none of them;
  // 0: none, but where that was looked for before.
  [[nodiscard]] std::uint32_t end_after_rapids() {
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
  [[nodiscard]] std::uint32_t cut_in_chain() {
    const std::uint32_t count = reader_.blocks_held();
    if (count < cut_from_) return 0;
    Chains chains(reader_.held(), grouping_);
    const auto beside = static_cast<std::uint32_t>(std::max<std::size_t>(grouping_.min_motions, 1));
    std::uint32_t lines = 0;  // that follow each other, from `i` on
    constexpr std::uint32_t kFurthest = 4096;
    for (std::uint32_t i = count; i > 0 && count - i < kFurthest; --i) {
      lines = chains.is_line(i - 1) ? lines + 1 : 0;
      if (lines < 2 * beside) continue;
      const std::uint32_t cut = i - 1 + beside;
      if (!chains.has_arc_from(cut) && !chains.has_arc_before(cut)) return cut;
      break;
    }
    cut_from_ = std::size_t{2} * count;  // not to search the same blocks for each part
    return 0;
  }

  // Inspects the first blocks that are held. False: the chain of the parts so far has an arc, and
  // is read again from its begin, to be held as one.
  bool take(std::uint32_t count, bool in_chain) {
    if (!in_chain_ && in_chain) begin_.emplace(Begin{reader_, inspection_.mark()});
    const gcode::ReadPart part = reader_.take(count);
    const bool goes_back = in_chain_ && Chains(part, grouping_).has_arc_from(0);
    if (goes_back) {
      reader_ = std::move(begin_->reader);
      inspection_.go_back_to(begin_->inspection);
      in_chain_ = false;
    } else {
      const std::vector<Section> sections = group_runs(part.program, part.meaning, grouping_);
      const bool is_run = !sections.empty() && sections.front().first_block == 0 &&
                          std::holds_alternative<Run>(sections.front().content);
      if (in_chain_ && !is_run) certain_ = false;
      inspection_.add(part, sections, in_chain_);
      if (misread_.empty() && target_ != nullptr) {
        misread_ = note_misread_arcs(part.program, part.meaning, *target_);
      }
      in_chain_ = in_chain;
    }
    if (!in_chain_) begin_.reset();
    looked_at_ = 0;
    cut_from_ = goes_back ? static_cast<std::size_t>(-1) : longest_;
    return !goes_back;
  }

  // Before the part that ends at the first cut of a chain.
  struct Begin {
    PartReader reader;
    Inspection::Mark inspection;
  };

  PartReader reader_;
  const GroupingOptions& grouping_;
  const gcode::Control* target_;
  gcode::Diagnostics misread_;
  Inspection inspection_;
  std::size_t longest_;
  bool in_chain_ = false;        // what is held goes on a chain that was cut
  std::uint32_t looked_at_ = 0;  // blocks that are held after which no part ends
  std::size_t cut_from_;         // so many blocks are held before a chain is cut
  std::optional<Begin> begin_;
  bool certain_ = true;  // that parts of a chain are runs: the whole is read where one is not
};

}  // namespace

std::vector<InspectedSection> inspect(const gcode::ReadPart& program,
                                      const GroupingOptions& grouping) {
  Inspection inspection(grouping);
  inspection.add(program, group_runs(program.program, program.meaning, grouping), false);
  return inspection.take();
}

InspectedProgram inspect(const gcode::SourceText& source, const PartReading& reading,
                         const GroupingOptions& grouping, const InspectLimits& limits,
                         const gcode::Control* target) {
  const auto inspected = [&](bool as_whole) {
    return PartInspector(source, reading, grouping, limits, target, as_whole).run();
  };
  if (reading.text.language == gcode::Language::kRs274 &&
      source.text().size() >= limits.parts.least_text) {
    if (auto in_parts = inspected(false)) return std::move(*in_parts);
  }
  return inspected(true).value();
}

}  // namespace batten::postproc
