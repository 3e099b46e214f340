#include "postproc/runs/run_grouping.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "gcode/state/block_words.h"
#include "gcode/state/reason.h"
#include "gcode/text/large_pages.h"
#include "geometry/basic/rounding.h"
#include "postproc/runs/run_path.h"

namespace batten::postproc {
namespace {

using gcode::BlockMeaning;
using gcode::ModalState;
using gcode::Motion;
using gcode::MotionMode;
using gcode::TriState;
using geometry::Point3;
namespace reason = gcode::reason;

// The part of the tolerance by which a run's points may miss its bends, taken off the smoothing's.
constexpr double kBendShare = 0.03;

// No coordinate is more than the distance: nearly always the first one that differs decides.
bool is_one_place(const Point3& a, const Point3& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(a[axis] - b[axis]) > geometry::kSamePlace) return false;
  }
  return (a - b).norm() <= geometry::kSamePlace;
}

bool has_length(const gcode::MotionPath& path) {
  if (const geometry::CubicBezier* cubic = path.cubic()) {
    return std::ranges::any_of(
        cubic->control, [&](const Point3& point) { return !is_one_place(path.start(), point); });
  }
  return path.arc() != nullptr || !is_one_place(path.start(), path.end());
}

// The states of which each forbids to rewrite.
struct UnsafeSwitch {
  TriState ModalState::*item;
  std::string_view reason;
};
constexpr UnsafeSwitch kUnsafeSwitches[] = {
    {&ModalState::cutter_compensation, reason::kCutterCompensation},
    {&ModalState::tool_center_point, reason::kToolCenterPoint},
    {&ModalState::tilted_plane, reason::kTiltedPlane},
    {&ModalState::polar, reason::kPolar},
    {&ModalState::polar_interpolation, reason::kPolar},
    {&ModalState::cylindrical, reason::kCylindrical},
    {&ModalState::scaling, reason::kScaling},
    {&ModalState::rotation, reason::kRotation},
    {&ModalState::mirror, reason::kMirror},
    {&ModalState::control_smoothing, reason::kControlSmoothing},
    {&ModalState::modal_macro, reason::kModalMacro},
    {&ModalState::constant_surface_speed, reason::kConstantSurfaceSpeed},
    {&ModalState::lathe_diameter, reason::kLatheDiameter},
};
// All but the laser's, which is never known to be on.
static_assert(std::size(kUnsafeSwitches) + 1 == gcode::kModalSwitches.size());

bool is_allowed(std::string_view id, const GroupingOptions& options) {
  return std::ranges::find(options.allowed, id) != options.allowed.end();
}

std::string_view unsafe_mode(const ModalState& state, const GroupingOptions& options) {
  for (const UnsafeSwitch& unsafe : kUnsafeSwitches) {
    if (state.*unsafe.item == TriState::kOn) return unsafe.reason;
  }
  if (state.distance == gcode::DistanceMode::kIncremental) return reason::kIncremental;
  if (state.feed_mode == gcode::FeedMode::kInverseTime) return reason::kInverseTime;
  if (state.feed_mode == gcode::FeedMode::kPerRevolution) return reason::kFeedPerRevolution;
  if (state.path.mode == gcode::PathMode::kExactStop ||
      (state.path.mode == gcode::PathMode::kExactPath &&
       !is_allowed(reason::kExactStop, options))) {
    return reason::kExactStop;
  }
  return {};
}

std::string_view unknown_state(ModalState state) {
  if (is_known(state)) return state.feed ? std::string_view{} : reason::kFeedUnknown;
  state.units = gcode::Units::kMillimetre;
  return is_known(state) ? reason::kUnitsUnknown : reason::kStateUnknown;
}

// A line or a cubic piece at one height.
bool is_at_one_height(const gcode::MotionPath& path) {
  const auto is_as_high = [&](const Point3& point) {
    return std::abs(point.z() - path.start().z()) <= geometry::kSamePlace;
  };
  const geometry::CubicBezier* cubic = path.cubic();
  return cubic != nullptr ? std::ranges::all_of(cubic->control, is_as_high)
                          : is_as_high(path.end());
}

class RunGrouper {
 public:
  RunGrouper(const gcode::Program& program, const gcode::Interpretation& read,
             const GroupingOptions& options, std::span<const std::uint32_t> cuts)
      : read_(read), blocks_(program, read), options_(options), states_(options), cuts_(cuts) {
    states_.begin(read);
  }

  std::vector<Section> group() {
    for (std::uint32_t i = 0; i < read_.blocks.size(); ++i) {
      if (!cuts_.empty() && cuts_.front() == i) start_anew(i);
      const BlockMeaning& block = read_.blocks[i];
      if (!block.barrier.empty() && !is_plain_arc(block) && !block.of_curve) {
        close_chain();
        keep_up_to(i, block.barrier);
      } else if (block.motion >= 0) {
        take_motion(i, blocks_.motion(i));
      } else if (block.of_curve) {
        keep_if_unsafe(i);
      } else if (chain_.empty()) {
        keep_idle(i);
      }
      // Blocks without motion inside a chain go with it, if it goes on behind them.
    }
    close_chain();
    keep_rest(static_cast<std::uint32_t>(read_.blocks.size()));
    return std::move(sections_);
  }

 private:
  void start_anew(std::uint32_t block) {
    close_chain();
    keep_rest(block);
    anew_ = sections_.size();
    cuts_ = cuts_.subspan(1);
  }

  static bool is_plain_arc(const BlockMeaning& block) {
    return block.barrier == reason::kArc && block.motion >= 0 &&
           block.kind == gcode::BlockKind::kMotion;
  }

  void take_motion(std::uint32_t i, const Motion& motion) {
    std::string_view why = states_.reason(read_.blocks[i].state_after);
    if (why.empty() && !motion.start_known) why = reason::kPositionUnknown;
    const double tolerance = tolerance_after(i);
    // Its comment would stand somewhere among the new moves.
    if (why.empty() && tolerance_changes_in(i)) why = reason::kStatedTolerance;
    if (!why.empty() || tolerance != tolerance_) close_chain();
    tolerance_ = tolerance;
    if (why.empty()) return chain_.push_back(i);
    keep_up_to(i, why);
  }

  // A block of a curve that has no motion of its own goes with those that have: their state is its.
  void keep_if_unsafe(std::uint32_t i) {
    const std::string_view why = states_.reason(read_.blocks[i].state_after);
    if (why.empty()) return;
    close_chain();
    keep_up_to(i, why);
  }

  // mm: what a motion in this block may be moved by.
  double tolerance_after(std::uint32_t block) const {
    return tolerance_in(read_.blocks[block].state_after);
  }
  double tolerance_before(std::uint32_t block) const {
    return tolerance_in(block > 0 ? read_.blocks[block - 1].state_after : 0);
  }
  double tolerance_in(std::uint32_t state) const {
    const double users = options_.tolerance_mm;
    return std::min(users, gcode::stated_tolerance_mm(read_.states[state]).value_or(users));
  }

  // In the block, or where it is one of a curve, in any of the curve's.
  bool tolerance_changes_in(std::uint32_t block) {
    if (!read_.blocks[block].of_curve) return tolerance_after(block) != tolerance_before(block);
    if (curve_known_to_ <= block) {
      const auto [first, last] = together_with(block, read_);
      curve_known_to_ = last + 1;
      tolerance_changes_in_curve_ = false;
      for (std::uint32_t i = first; i <= last; ++i) {
        tolerance_changes_in_curve_ |= tolerance_after(i) != tolerance_before(i);
      }
    }
    return tolerance_changes_in_curve_;
  }

  // Intended arcs are copied, and the chain is cut there and at corners beside arcs and curves.
  void close_chain() {
    const auto is_bend = [this](std::uint32_t block) { return blocks_.is_bend(block); };
    if (std::ranges::none_of(chain_, is_bend)) return close_section();
    const std::vector<std::uint32_t> whole = std::exchange(chain_, {});
    std::vector<PrintedMotion> moving;
    std::vector<std::size_t> first_of;  // by block of the chain: its first motion
    for (const std::uint32_t block : whole) {
      first_of.push_back(moving.size());
      blocks_.add_printed(block, moving);
    }
    const ChainJudgement judged = judge_arcs(moving, blocks_.errors_of(whole), tolerance_);
    for (std::size_t k = 0; k < whole.size(); ++k) {
      const std::uint32_t block = whole[k];
      if (!blocks_.moves(block)) {
        chain_.push_back(block);
        continue;
      }
      const std::size_t i = first_of[k];
      if (judged.starts_part[i] && blocks_.can_start(block)) close_section();
      if (judged.kept[i]) {
        close_section();
        keep_up_to(block, reason::kIntendedArc);
      } else {
        chain_.push_back(block);
      }
    }
    close_section();
  }

  // Plunge or retract: the corner where it meets the cut is intentional, and rounding it would tilt
  // the cut out of its plane. So plunges are copied, and the chain is cut there. Straight down in
  // the midst of a surface is no plunge; at its begin or end it is.
  void close_section() {
    const std::vector<std::uint32_t> whole = std::exchange(chain_, {});
    for (std::size_t i = 0; i < whole.size();) {
      const std::size_t end = end_of_plunge(whole, i);
      if (end == i) {
        chain_.push_back(whole[i++]);
        continue;
      }
      close_part();
      keep_up_to(whole[end - 1], reason::kPlunge);
      i = end;
    }
    close_part();
  }

  // After the moves along Z that start at `begin`, when they are a plunge; `begin` otherwise.
  std::size_t end_of_plunge(const std::vector<std::uint32_t>& chain, std::size_t begin) const {
    using Heading = RunBlocks::Heading;
    const auto flat = [&](std::size_t k) { return blocks_.heading(chain[k]) == Heading::kInPlane; };
    // Of a curve no piece is taken for itself, of no length either.
    const auto along_z = [&](std::size_t k) {
      if (blocks_.moves(chain[k])) return blocks_.heading(chain[k]) == Heading::kAlongZ;
      return !read_.blocks[chain[k]].of_curve;
    };
    std::size_t end = begin;
    while (end < chain.size() && along_z(end)) ++end;
    if (end == begin || !blocks_.moves(chain[begin])) return begin;
    std::size_t before = begin;
    while (before > 0 && !blocks_.moves(chain[before - 1])) --before;
    const bool outermost = before == 0 || end == chain.size();
    return outermost || (flat(before - 1) && flat(end)) ? end : begin;
  }

  // Motions of no length at the ends of a chain say nothing about its path: they are copied. So are
  // arcs and curves at its end whose motion word is needed after it.
  void close_part() {
    if (chain_.empty()) return;
    const auto moving = [this](std::uint32_t block) { return blocks_.moves(block); };
    const auto first = std::find_if(chain_.cbegin(), chain_.cend(), moving);
    const auto last = end_of_run();
    const std::uint32_t end = together_with(chain_.back(), read_).last;
    if (first >= last || is_too_short({first, last})) {
      keep_up_to(end, is_too_short({first, chain_.cend()}) ? reason::kTooShort : why_kept(*last));
    } else {
      const std::uint32_t begin = together_with(*first, read_).first;
      if (chain_.front() < begin) keep_up_to(begin - 1, reason::kTooShort);
      add_run({first, last});
      if (done_ <= end) keep_up_to(end, why_kept(*last));
    }
    chain_.clear();
  }

  // After the last motion with which a run may end: one that moves, and whose word, or that of its
  // curve, nobody needs.
  [[nodiscard]] std::vector<std::uint32_t>::const_iterator end_of_run() const {
    auto last = chain_.cend();
    while (last != chain_.cbegin()) {
      const std::uint32_t block = *(last - 1);
      if (!blocks_.moves(block)) {
        --last;
        continue;
      }
      if (!blocks_.lends_motion_word(block)) break;
      const std::uint32_t first = together_with(block, read_).first;
      while (last != chain_.cbegin() && *(last - 1) >= first) --last;
    }
    return last;
  }

  [[nodiscard]] bool is_too_short(std::span<const std::uint32_t> blocks) const {
    const auto moving = [this](std::uint32_t block) { return blocks_.moves(block); };
    const auto count = static_cast<std::size_t>(std::ranges::count_if(blocks, moving));
    return count == 0 || count < options_.min_motions;
  }

  // What follows the end of a run and could not be in it.
  [[nodiscard]] std::string_view why_kept(std::uint32_t block) const {
    if (!blocks_.moves(block)) return reason::kTooShort;
    return read_.blocks[block].of_curve ? reason::kSpline : reason::kArc;
  }

  void add_run(std::span<const std::uint32_t> blocks) {
    const std::uint32_t first = together_with(blocks.front(), read_).first;
    const std::uint32_t last = together_with(blocks.back(), read_).last;
    if (done_ < first) keep_up_to(first - 1, reason::kComment);
    Run run = blocks_.run_of(blocks, kBendShare * tolerance_);
    run.stated_tolerance_mm = gcode::least_stated_mm(read_, first, last);
    add({first, last, std::move(run)});
  }

  void add(Section section) {
    done_ = section.last_block + 1;
    sections_.push_back(std::move(section));
  }

  // The last section, where it is copied and may take in what follows.
  [[nodiscard]] const Verbatim* copied_before() const {
    if (sections_.size() <= anew_) return nullptr;
    return std::get_if<Verbatim>(&sections_.back().content);
  }

  void extend_to(std::uint32_t last) {
    sections_.back().last_block = last;
    done_ = last + 1;
  }

  // Blocks that say nothing wait for the next section after a run.
  void keep_idle(std::uint32_t i) {
    if (copied_before() != nullptr && sections_.back().last_block + 1 == i) extend_to(i);
  }

  // Everything up to `last` that has no section yet, for this reason.
  void keep_up_to(std::uint32_t last, std::string_view why) {
    const Verbatim* before = copied_before();
    if (before != nullptr && before->reason == why) return extend_to(last);
    add({done_, last, Verbatim{why}});
  }

  // What is left of the blocks before `end`.
  void keep_rest(std::uint32_t end) {
    if (done_ == end) return;
    if (copied_before() != nullptr) return extend_to(end - 1);
    add({done_, end - 1, Verbatim{reason::kComment}});
  }

  const gcode::Interpretation& read_;
  RunBlocks blocks_;
  const GroupingOptions& options_;
  UnsafeStates states_;
  std::span<const std::uint32_t> cuts_;  // that are still ahead
  std::vector<Section> sections_;
  std::size_t anew_ = 0;              // sections before the last cut
  std::vector<std::uint32_t> chain_;  // motion blocks that may become a run
  double tolerance_ = 0;              // mm: of all of them
  std::uint32_t curve_known_to_ = 0;  // the block behind the last curve whose tolerance was asked
  bool tolerance_changes_in_curve_ = false;
  std::uint32_t done_ = 0;  // blocks before this one are in sections
};

}  // namespace

std::vector<Section> group_runs(const gcode::Program& program,
                                const gcode::Interpretation& interpretation,
                                const GroupingOptions& options,
                                std::span<const std::uint32_t> cuts) {
  return RunGrouper(program, interpretation, options, cuts).group();
}

std::string_view unsafe_state(const ModalState& state, const GroupingOptions& options) {
  ModalState asked = state;
  if (is_allowed(reason::kControlSmoothing, options)) asked.control_smoothing = TriState::kOff;
  const std::string_view mode = unsafe_mode(asked, options);
  return mode.empty() ? unknown_state(asked) : mode;
}

void UnsafeStates::begin(const gcode::Interpretation& read) {
  read_ = &read;
  asked_.reset();
}

std::string_view UnsafeStates::reason(std::uint32_t state) {
  if (asked_ != state) {
    asked_ = state;
    answer_ = unsafe_state(read_->states[state], options_);
  }
  return answer_;
}

BlockRange together_with(std::uint32_t block, const gcode::Interpretation& read) {
  BlockRange range{block, block};
  if (!read.blocks[block].of_curve) return range;
  while (!read.blocks[range.first].begins_curve) --range.first;
  const auto goes_on = [&](std::uint32_t next) {
    return next < read.blocks.size() && read.blocks[next].of_curve &&
           !read.blocks[next].begins_curve;
  };
  while (goes_on(range.last + 1)) ++range.last;
  return range;
}

std::vector<std::uint32_t> blocks_of_edges(const Section& section,
                                           const gcode::Interpretation& read) {
  const Run& run = std::get<Run>(section.content);
  std::vector<std::uint32_t> of_edges;
  of_edges.reserve(run.points.size());
  auto bend = run.bends.begin();
  for (std::uint32_t block = section.first_block; block <= section.last_block; ++block) {
    for (const gcode::Motion& motion : gcode::motions_of(read, block)) {
      if (!has_length(motion.piece)) continue;
      const bool is_bend = bend != run.bends.end() && bend->first == of_edges.size();
      of_edges.insert(of_edges.end(), is_bend ? bend->last - bend->first : 1, block);
      if (is_bend) ++bend;
    }
  }
  return of_edges;
}

const geometry::Arc* RunBlocks::arc(std::uint32_t block) const { return motion(block).piece.arc(); }

bool RunBlocks::is_bend(std::uint32_t block) const {
  return arc(block) != nullptr || read_.blocks[block].of_curve;
}

bool RunBlocks::moves(std::uint32_t block) const {
  if (!read_.blocks[block].of_curve) return has_length(motion(block).piece);
  return std::ranges::any_of(motions(block), has_length, &Motion::piece);
}

RunBlocks::Heading RunBlocks::heading(std::uint32_t block) const {
  const gcode::MotionPath& path = motion(block).piece;
  const geometry::Vector3 way = path.end() - path.start();
  const bool along = std::abs(way.z()) > geometry::kSamePlace;
  if (const geometry::Arc* bend = path.arc()) {
    const bool about_z = std::abs(bend->axis.z()) > 1 - geometry::kSameDirection;
    return about_z && !along ? Heading::kInPlane : Heading::kOther;
  }
  if (read_.blocks[block].of_curve) {
    const bool level = std::ranges::all_of(motions(block), is_at_one_height, &Motion::piece);
    return level ? Heading::kInPlane : Heading::kOther;
  }
  const bool across = way.head<2>().cwiseAbs().maxCoeff() > geometry::kSamePlace;
  if (along && !across) return Heading::kAlongZ;
  return across && !along ? Heading::kInPlane : Heading::kOther;
}

bool RunBlocks::names_motion(std::uint32_t block) const {
  if (read_.blocks[block].begins_curve) return true;
  const gcode::BlockWords words(program_.words_of(program_.blocks[block]));
  return words.has_group(gcode::CodeGroup::kMotion);
}

bool RunBlocks::can_start(std::uint32_t block) const {
  if (!read_.blocks[block].of_curve) return arc(block) == nullptr || names_motion(block);
  while (!read_.blocks[block].begins_curve) {
    if (read_.blocks[--block].motion >= 0) return false;
  }
  return true;
}

bool RunBlocks::says_speed(std::uint32_t block) const {
  return gcode::BlockWords(program_.words_of(program_.blocks[block])).has('S');
}

bool RunBlocks::lends_motion_word(std::uint32_t block) const {
  const MotionMode mode = read_.states[read_.blocks[block].state_after].motion;
  if (!gcode::is_arc(mode) && mode != MotionMode::kOther) return false;
  for (std::uint32_t i = together_with(block, read_).last + 1; i < read_.blocks.size(); ++i) {
    if (read_.blocks[i].kind == gcode::BlockKind::kEmpty) continue;
    if (names_motion(i)) return mode == MotionMode::kOther && goes_on_as_curve(i);
    if (!says_only_functions(i)) return true;
  }
  return false;
}

// A curve that is not read may go on from the one before it: G5 without I and J.
bool RunBlocks::goes_on_as_curve(std::uint32_t block) const {
  return !read_.blocks[block].of_curve &&
         read_.states[read_.blocks[block].state_after].motion == MotionMode::kOther;
}

// M, S, T words and the like: they do the same in any motion mode.
bool RunBlocks::says_only_functions(std::uint32_t block) const {
  const BlockMeaning& meaning = read_.blocks[block];
  if (meaning.kind == gcode::BlockKind::kOpaque || meaning.motion >= 0 ||
      meaning.label_referenced || meaning.entered_from_elsewhere ||
      meaning.barrier == gcode::reason::kSubprogram) {
    return false;
  }
  constexpr std::string_view kFunctions = "NFSTDHM";
  return std::ranges::all_of(program_.words_of(program_.blocks[block]),
                             [&](const gcode::Word& word) {
                               return kFunctions.find(word.letter) != std::string_view::npos;
                             });
}

void RunBlocks::add_printed(std::uint32_t block, std::vector<PrintedMotion>& moving) const {
  const bool arc = this->arc(block) != nullptr;
  const bool by_radius =
      arc && gcode::BlockWords(program_.words_of(program_.blocks[block])).has('R');
  for (const Motion& motion : motions(block)) {
    if (has_length(motion.piece)) moving.push_back({motion.piece, by_radius});
  }
}

PrintedErrors RunBlocks::errors_of(std::span<const std::uint32_t> blocks) const {
  int of_places = 0;
  int of_centers = 0;
  for (const std::uint32_t block : blocks) {
    of_places = std::max(of_places, decimals_of_places(block));
    of_centers = std::max(of_centers, decimals(block, "IJKR"));
  }
  const gcode::ModalState& state = read_.states[read_.blocks[blocks.front()].state_after];
  const double unit = gcode::millimetres_per(state.units);
  return {unit / 2 * std::pow(10.0, -of_places), unit / 2 * std::pow(10.0, -of_centers)};
}

int RunBlocks::decimals_of_places(std::uint32_t block) const {
  return read_.blocks[block].of_curve ? motion(block).curve_decimals : decimals(block, "XYZ");
}

// Most digits after the point among the block's words of these letters.
int RunBlocks::decimals(std::uint32_t block, std::string_view letters) const {
  int most = 0;
  for (const gcode::Word& word : program_.words_of(program_.blocks[block])) {
    // In this order: the search is a call.
    if (word.decimals > most && letters.find(word.letter) != std::string_view::npos) {
      most = word.decimals;
    }
  }
  return most;
}

Run RunBlocks::run_of(std::span<const std::uint32_t> blocks, double max_chord_error) const {
  Run run;
  const std::uint32_t begin = together_with(blocks.front(), read_).first;
  const std::uint32_t end = together_with(blocks.back(), read_).last;
  run.state = begin == 0 ? 0 : read_.blocks[begin - 1].state_after;
  run.decimals = 0;
  gcode::reserve_in_large_pages(run.points, blocks.size() + 1);
  run.points.push_back(motion(blocks.front()).piece.start());
  std::size_t next = 0;
  // Comments whose vertex is known: that of the next block that moves, the last one where none
  // does.
  std::size_t placed = 0;
  const auto place_comments = [&] {
    for (; placed < run.comments.size(); ++placed) {
      run.comments[placed].vertex = run.points.size() - 1;
    }
  };
  for (std::uint32_t i = begin; i <= end; ++i) {
    const bool has_motion = next < blocks.size() && blocks[next] == i;
    for (const gcode::Comment& comment : program_.comments_of(program_.blocks[i])) {
      run.comments.push_back({0, comment.span, has_motion});
    }
    if (!has_motion) continue;
    ++next;
    if (!moves(i)) continue;  // its feed is still there at the next motion that moves
    add_motion(i, max_chord_error, run);
    place_comments();
  }
  place_comments();
  run.closed = is_one_place(run.points.front(), run.points.back());
  return run;
}

void RunBlocks::add_motion(std::uint32_t block, double max_chord_error, Run& run) const {
  const double feed = *read_.states[read_.blocks[block].state_after].feed;
  if (run.feeds.empty() || run.feeds.back().feed != feed) {
    run.feeds.push_back({run.points.size() - 1, feed});
  }
  run.decimals = std::max(run.decimals, decimals_of_places(block));
  if (says_speed(block)) run.speed_words.push_back(run.points.size() - 1);
  if (!is_bend(block)) {
    run.points.push_back(motion(block).piece.end());
    return;
  }
  RunBend bend;
  bend.can_start = can_start(block);
  for (const Motion& motion : motions(block)) {
    if (!has_length(motion.piece)) continue;
    bend.piece = motion.piece;
    bend.arcs = motion.arcs;
    append_bend(bend, motions(block).size(), max_chord_error, run);
    bend.can_start = false;
    bend.goes_on = true;
  }
}

}  // namespace batten::postproc
