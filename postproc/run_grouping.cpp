#include "postproc/run_grouping.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "gcode/reason.h"
#include "geometry/numeric.h"

namespace batten::postproc {
namespace {

using gcode::BlockMeaning;
using gcode::ModalState;
using gcode::Motion;
using gcode::Tri;
namespace reason = gcode::reason;

bool is_one_place(const geometry::Point3& a, const geometry::Point3& b) {
  return (a - b).norm() <= geometry::kSamePlace;
}

// The states of which each forbids to rewrite.
struct UnsafeSwitch {
  Tri ModalState::*item;
  std::string_view reason;
};
constexpr UnsafeSwitch kUnsafeSwitches[] = {
    {&ModalState::cutter_compensation, reason::kCutterCompensation},
    {&ModalState::tool_center_point, reason::kToolCenterPoint},
    {&ModalState::tilted_plane, reason::kTiltedPlane},
    {&ModalState::polar, reason::kPolar},
    {&ModalState::cylindrical, reason::kCylindrical},
    {&ModalState::scaling, reason::kScaling},
    {&ModalState::rotation, reason::kRotation},
    {&ModalState::mirror, reason::kMirror},
    {&ModalState::control_smoothing, reason::kControlSmoothing},
    {&ModalState::modal_macro, reason::kModalMacro},
    {&ModalState::constant_surface_speed, reason::kConstantSurfaceSpeed},
    {&ModalState::lathe_diameter, reason::kLatheDiameter},
};

// States that stand for themselves, before anything is said about what is unknown.
std::string_view unsafe_mode(const ModalState& state, bool exact_path_allowed) {
  for (const UnsafeSwitch& unsafe : kUnsafeSwitches) {
    if (state.*unsafe.item == Tri::kOn) {
      return unsafe.reason;
    }
  }
  if (state.distance == gcode::DistanceMode::kIncremental) {
    return reason::kIncremental;
  }
  if (state.feed_mode == gcode::FeedMode::kInverseTime) {
    return reason::kInverseTime;
  }
  if (state.feed_mode == gcode::FeedMode::kPerRevolution) {
    return reason::kFeedPerRevolution;
  }
  if (state.path == gcode::PathMode::kExactStop ||
      (state.path == gcode::PathMode::kExactPath && !exact_path_allowed)) {
    return reason::kExactStop;
  }
  return {};
}

std::string_view unknown_state(const ModalState& state) {
  if (!is_known(state)) {
    ModalState with_units = state;
    with_units.units = gcode::Units::kMillimetre;
    return is_known(with_units) ? reason::kUnitsUnknown : reason::kStateUnknown;
  }
  return state.feed ? std::string_view{} : reason::kFeedUnknown;
}

class RunGrouper {
 public:
  RunGrouper(const gcode::Program& program, const gcode::Interpretation& read,
             const GroupingOptions& options)
      : program_(program), read_(read), options_(options) {}

  std::vector<Section> group() {
    for (std::uint32_t i = 0; i < read_.blocks.size(); ++i) {
      const BlockMeaning& block = read_.blocks[i];
      if (!block.barrier.empty()) {
        close_chain();
        keep(i, block.barrier);
      } else if (block.motion >= 0) {
        take_motion(i, read_.motions[static_cast<std::size_t>(block.motion)]);
      } else if (chain_.empty()) {
        keep_idle(i);
      }
      // Blocks without motion inside a chain go with it, if it goes on behind them.
    }
    close_chain();
    keep_rest();
    return std::move(sections_);
  }

 private:
  void take_motion(std::uint32_t i, const Motion& motion) {
    std::string_view why = reason_in_state(read_.blocks[i].state_after);
    if (why.empty() && !motion.start_known) {
      why = reason::kPositionUnknown;
    }
    if (!why.empty()) {
      close_chain();
      keep(i, why);
      return;
    }
    chain_.push_back(i);
  }

  // States are shared by many blocks: ask once for each.
  std::string_view reason_in_state(std::uint32_t state) {
    if (asked_state_ != state) {
      asked_state_ = state;
      answer_ = unsafe_state(read_.states[state], options_);
    }
    return answer_;
  }

  // --- runs ---------------------------------------------------------------------------------

  const geometry::Line& line_of(std::uint32_t block) const {
    const auto motion = static_cast<std::size_t>(read_.blocks[block].motion);
    return std::get<geometry::Line>(read_.motions[motion].piece);
  }

  bool moves(std::uint32_t block) const {
    const geometry::Line& line = line_of(block);
    return !is_one_place(line.start, line.end);
  }

  // Whether a block moves straight along Z, in the plane across it, or neither.
  enum class Heading { kAlongZ, kInPlane, kOther };

  Heading heading(std::uint32_t block) const {
    const geometry::Vector3 way = line_of(block).end - line_of(block).start;
    const bool across =
        std::abs(way.x()) > geometry::kSamePlace || std::abs(way.y()) > geometry::kSamePlace;
    const bool along = std::abs(way.z()) > geometry::kSamePlace;
    if (along && !across) {
      return Heading::kAlongZ;
    }
    return across && !along ? Heading::kInPlane : Heading::kOther;
  }

  // The tool goes down into a cut and comes up out of it: where such a move meets the cut is a
  // corner that was meant, and rounding it would tilt the cut out of its plane. So plunges are
  // copied, and the chain is cut there. Straight down in the midst of a surface is no plunge.
  void close_chain() {
    std::vector<std::uint32_t> whole = std::exchange(chain_, {});
    std::size_t i = 0;
    while (i < whole.size()) {
      const std::size_t end = end_of_plunge(whole, i);
      if (end == i) {
        chain_.push_back(whole[i++]);
        continue;
      }
      close_part();
      keep(whole[end - 1], reason::kPlunge);
      i = end;
    }
    close_part();
  }

  // Behind the moves along Z that start at `begin`, when they are a plunge; `begin` otherwise.
  std::size_t end_of_plunge(const std::vector<std::uint32_t>& chain, std::size_t begin) const {
    const auto flat = [&](std::size_t k) { return heading(chain[k]) == Heading::kInPlane; };
    std::size_t end = begin;
    while (end < chain.size() && (!moves(chain[end]) || heading(chain[end]) == Heading::kAlongZ)) {
      ++end;
    }
    if (end == begin || !moves(chain[begin])) {
      return begin;
    }
    std::size_t before = begin;
    while (before > 0 && !moves(chain[before - 1])) {
      --before;
    }
    const bool flat_before = before == 0 || flat(before - 1);
    const bool flat_after = end == chain.size() || flat(end);
    return flat_before && flat_after ? end : begin;
  }

  // Motions of no length at the ends of a chain say nothing about its path: they are copied.
  void close_part() {
    const auto moving = [this](std::uint32_t block) { return moves(block); };
    const auto first = std::find_if(chain_.begin(), chain_.end(), moving);
    const auto last = std::find_if(chain_.rbegin(), chain_.rend(), moving).base();
    const auto count = first < last ? std::count_if(first, last, moving) : 0;
    if (chain_.empty()) {
      return;
    }
    if (count == 0 || static_cast<std::size_t>(count) < options_.min_motions) {
      keep_up_to(chain_.back(), reason::kTooShort);
    } else {
      if (first != chain_.begin()) {
        keep_up_to(*first - 1, reason::kTooShort);
      }
      add_run(std::vector<std::uint32_t>(first, last));
      if (last != chain_.end()) {
        keep_up_to(chain_.back(), reason::kTooShort);
      }
    }
    chain_.clear();
  }

  void add_run(const std::vector<std::uint32_t>& blocks) {
    close_idle_before(blocks.front());
    Run run;
    run.state = state_before(blocks.front());
    run.decimals = 0;
    run.points.reserve(blocks.size() + 1);
    run.points.push_back(line_of(blocks.front()).start);
    std::size_t next = 0;
    for (std::uint32_t i = blocks.front(); i <= blocks.back(); ++i) {
      add_comments(i, run);
      if (blocks[next] == i) {
        add_motion(i, run);
        ++next;
      }
    }
    // Comments of motions without length behind the last vertex do not exist: the chain ends
    // with a motion that moves.
    run.closed = is_one_place(run.points.front(), run.points.back());
    sections_.push_back({blocks.front(), blocks.back(), std::move(run)});
    done_ = blocks.back() + 1;
  }

  void add_motion(std::uint32_t block, Run& run) const {
    const std::size_t from = run.points.size() - 1;
    const double feed = *read_.states[read_.blocks[block].state_after].feed;
    if (!moves(block)) {
      return;  // its feed is still there at the next motion that moves
    }
    if (run.feeds.empty() || run.feeds.back().feed != feed) {
      run.feeds.push_back({from, feed});
    }
    run.points.push_back(line_of(block).end);
    for (const gcode::Word& word : program_.words_of(program_.blocks[block])) {
      if (word.letter >= 'X' && word.letter <= 'Z') {
        run.decimals = std::max(run.decimals, static_cast<int>(word.decimals));
      }
    }
  }

  // The vertex that the block leads to, or for blocks without motion the next motion does.
  void add_comments(std::uint32_t block, Run& run) const {
    for (const gcode::Comment& comment : program_.comments_of(program_.blocks[block])) {
      run.comments.push_back({run.points.size(), comment.span});
    }
  }

  std::uint32_t state_before(std::uint32_t block) const {
    return block == 0 ? 0 : read_.blocks[block - 1].state_after;
  }

  // --- what is kept -------------------------------------------------------------------------

  // Blocks [done_, ..] have no section yet. Those that say nothing wait for the next section.
  void keep_idle(std::uint32_t i) {
    if (!sections_.empty() && sections_.back().last_block + 1 == i) {
      if (std::holds_alternative<Verbatim>(sections_.back().content)) {
        sections_.back().last_block = i;
        done_ = i + 1;
      }
    }
  }

  void keep(std::uint32_t last, std::string_view why) { keep_up_to(last, why); }

  // Everything up to `last` that has no section yet, for this reason.
  void keep_up_to(std::uint32_t last, std::string_view why) {
    if (!sections_.empty()) {
      auto* before = std::get_if<Verbatim>(&sections_.back().content);
      if (before != nullptr && before->reason == why) {
        sections_.back().last_block = last;
        done_ = last + 1;
        return;
      }
    }
    sections_.push_back({done_, last, Verbatim{why}});
    done_ = last + 1;
  }

  void close_idle_before(std::uint32_t block) {
    if (done_ < block) {
      keep_up_to(block - 1, reason::kComment);
    }
  }

  void keep_rest() {
    const auto count = static_cast<std::uint32_t>(read_.blocks.size());
    if (done_ == count) {
      return;
    }
    if (!sections_.empty() && std::holds_alternative<Verbatim>(sections_.back().content)) {
      sections_.back().last_block = count - 1;
    } else {
      sections_.push_back({done_, count - 1, Verbatim{reason::kComment}});
    }
  }

  const gcode::Program& program_;
  const gcode::Interpretation& read_;
  const GroupingOptions& options_;
  std::vector<Section> sections_;
  std::vector<std::uint32_t> chain_;  // motion blocks that may become a run
  std::uint32_t done_ = 0;            // blocks before this one are in sections
  std::optional<std::uint32_t> asked_state_;
  std::string_view answer_;
};

}  // namespace

std::vector<Section> group_runs(const gcode::Program& program,
                                const gcode::Interpretation& interpretation,
                                const GroupingOptions& options) {
  return RunGrouper(program, interpretation, options).group();
}

std::string_view unsafe_state(const ModalState& state, const GroupingOptions& options) {
  const bool exact_path_allowed =
      std::ranges::find(options.allowed, reason::kExactStop) != options.allowed.end();
  const std::string_view mode = unsafe_mode(state, exact_path_allowed);
  return mode.empty() ? unknown_state(state) : mode;
}

}  // namespace batten::postproc
