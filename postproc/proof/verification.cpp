#include "postproc/proof/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "gcode/controls/arc_rules.h"
#include "gcode/reading/part_reading.h"
#include "geometry/basic/rounding.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {
namespace {

using geometry::Verdict;

// Follows one program from event to event and knows where the tool is.
class Follower {
 public:
  Follower(const ReadProgram& read, const ProgramEvents& list)
      : read_(read), list_(list), line_(read.line_before) {}

  // Goes past event `index`, or to the end. Returns the moves on the way, with all events
  // between left out.
  SectionSide move_to(std::size_t index) {
    SectionSide side{&read_, {}, position(), line_};
    const std::size_t begin = cut_;
    for (; next_event_ < index; ++next_event_) pass(list_.events[next_event_]);
    cut_ = list_.cuts_before[index];
    side.cuts = {list_.cuts.data() + begin, cut_ - begin};
    side.stated_tolerance_mm = gcode::stated_tolerance_mm(state_at(index));
    if (index < list_.events.size()) pass(list_.events[next_event_++]);
    return side;
  }

 private:
  // Before the event, or at the end.
  [[nodiscard]] const gcode::ModalState& state_at(std::size_t index) const {
    const gcode::Interpretation& read = *read_.interpretation;
    if (index < list_.events.size()) return read.states[list_.events[index].state_before];
    return read.states[read.blocks.empty() ? 0 : read.blocks.back().state_after];
  }

  void pass(const ProgramEvent& event) {
    block_ = event.block;
    line_ = read_.program->blocks[event.block].line;
    // What is not understood may move the tool.
    if (event.kind == EventKind::kText && read_.interpretation->blocks[event.block].motion < 0) {
      lost_after_ = event.block;
    }
  }

  // The end of the last motion that happened before or in the block of the last event.
  [[nodiscard]] std::optional<geometry::Point3> position() const {
    if (!block_) return read_.before.place;
    const auto& motions = read_.interpretation->motions;
    const auto next = std::ranges::upper_bound(motions, *block_, {}, &gcode::Motion::block);
    if (next == motions.begin()) return lost_after_ ? std::nullopt : read_.before.place;
    const gcode::Motion& last = *(next - 1);
    if (!last.end_known || (lost_after_ && last.block <= *lost_after_)) return {};
    return last.piece.end();
  }

  const ReadProgram& read_;
  const ProgramEvents& list_;
  std::size_t next_event_ = 0;
  std::size_t cut_ = 0;
  std::optional<std::uint32_t> block_;  // of the last event passed
  std::uint32_t line_;
  std::optional<std::uint32_t> lost_after_;
};

class Verifier {
 public:
  Verifier(const ReadProgram& before, const ReadProgram& after, const Promise& promise, int threads)
      : old_(before),
        new_(after),
        promise_(promise),
        two_languages_(before.program->language != after.program->language),
        threads_(threads),
        old_list_(events_of(before, old_made_)),
        new_list_(events_of(after, new_made_)) {}

  Verification run() {
    const EventPair end{old_list_.events.size(), new_list_.events.size()};
    const EventAlignment aligned = align_events(old_span(0, end.before), new_span(0, end.after));
    find_moves(aligned, end);
    compare_ahead();
    for (Moves& moves : moves_) {
      GapReport gap = report_events_between(old_span(moves.from.before, moves.to.before),
                                            new_span(moves.from.after, moves.to.after));
      std::ranges::move(gap.violations, std::back_inserter(result_.violations));
      compare_moves(moves, gap.only_words);
      if (moves.to == end) continue;
      compare_places(moves);
      compare_event(moves.to);
    }
    if (!aligned.complete) {
      flush_stretch();
      const EventPair next = behind_last_of(aligned);
      result_.violations.push_back(
          too_many_differences(old_span(next.before, end.before), new_span(next.after, end.after)));
    } else if (!two_languages_) {
      compare_end();
    }
    flush_stretch();
    merge_moved_events(result_.violations);
    result_.events_compared = aligned.same.size();
    return std::move(result_);
  }

 private:
  // --- events -------------------------------------------------------------------------------

  [[nodiscard]] const ProgramEvents& events_of(const ReadProgram& read, ProgramEvents& made) const {
    if (read.events != nullptr && !two_languages_) return *read.events;
    return made = two_languages_ ? list_common_events(read) : list_events(read);
  }

  [[nodiscard]] EventSpan old_span(std::size_t begin, std::size_t end) const {
    return {{old_list_.events.data() + begin, end - begin}, &old_};
  }
  [[nodiscard]] EventSpan new_span(std::size_t begin, std::size_t end) const {
    return {{new_list_.events.data() + begin, end - begin}, &new_};
  }
  [[nodiscard]] EventAt old_event(const EventPair& pair) const {
    return {old_list_.events[pair.before], old_};
  }
  [[nodiscard]] EventAt new_event(const EventPair& pair) const {
    return {new_list_.events[pair.after], new_};
  }

  void compare_event(const EventPair& same) {
    const EventAt before = old_event(same);
    const EventAt after = new_event(same);
    if (before.event.kind == EventKind::kRapid) compare_unnamed_axes(before, after);
    const std::string_view item = different_item(before, after);
    if (!item.empty() && item != last_different_item_) {
      result_.violations.push_back(state_violation(item, before, after));
    }
    last_different_item_ = item;
  }

  // A rapid starts, and stays on the axes that it does not name, where the moves before it have
  // left the tool: within the tolerance.
  void compare_unnamed_axes(const EventAt& before, const EventAt& after) {
    const gcode::MotionPath& old_path = before.motion().piece;
    const gcode::MotionPath& new_path = after.motion().piece;
    const double start = (old_path.start() - new_path.start()).norm();
    const double end = (old_path.end() - new_path.end()).norm();
    // Rounding of the printed decimals is far above, that of doubles far below this share.
    constexpr double kRounding = 1e-9;
    const double promised = promise_.tolerance_mm;
    const double allowed =
        std::min(promised, gcode::stated_tolerance_mm(before.state_before()).value_or(promised));
    if (std::max(start, end) <= allowed * (1 + kRounding)) return;
    result_.violations.push_back(rapid_violation(before, after));
  }

  // The end of a program of another language leaves what that control leaves.
  void compare_end() {
    const bool feed_counts = old_list_.at_end.feed_is_new || new_list_.at_end.feed_is_new;
    const std::string_view item = different_item_at_end(old_, new_, feed_counts);
    if (item.empty() || item == last_different_item_) return;
    result_.violations.push_back(end_state_violation(item, old_, new_));
  }

  // --- moves --------------------------------------------------------------------------------

  // The moves before a pair of events that are the same, or before the ends of both programs.
  struct Moves {
    EventPair from;  // the first events after the pair before: others than `to` are a gap
    EventPair to;
    SectionSide before;
    SectionSide after;
    std::optional<SectionComparison> result = {};

    [[nodiscard]] bool any() const { return !before.cuts.empty() || !after.cuts.empty(); }
  };

  // What takes over where the tool stands (G92 X1) carries its distance from where it stood into
  // all that follows, where no path shows it any more. An axis that is not known stands at 0: it is
  // off as it was until a move names it.
  void compare_places(const Moves& moves) {
    const EventAt before = old_event(moves.to);
    const EventAt after = new_event(moves.to);
    for (const Cut& cut : moves.after.cuts) name_axes_of(cut.motion);
    const auto old_place = end_of(moves.before);
    const auto new_place = end_of(moves.after);
    for (Eigen::Index i = 0; i < 3 && (old_place || new_place); ++i) {
      const bool both = old_place && new_place;
      const double off = both ? std::abs((*old_place)[i] - (*new_place)[i]) : 0;
      if (!both || off > same_place_at(before, after)) {
        place_off_[i] = std::max(off, geometry::kSamePlace);
      } else if (named_[static_cast<std::size_t>(i)]) {
        place_off_[i] = 0;
      }
    }
    named_ = {};
    const std::int32_t motion = new_.interpretation->blocks[after.event.block].motion;
    if (motion >= 0) name_axes_of(static_cast<std::uint32_t>(motion));
    if (place_off_.isZero() || !hangs_on_place(before)) return;
    result_.violations.push_back(place_violation(before, after, place_off_.norm()));
    place_off_.setZero();  // it is said once
  }

  void name_axes_of(std::uint32_t index) {
    const gcode::Motion& motion = new_.interpretation->motions[index];
    for (std::size_t i = 0; i < named_.size(); ++i) {
      named_[i] = named_[i] || (motion.end_known && motion.axes_named[i]);
    }
  }

  static std::optional<geometry::Point3> end_of(const SectionSide& side) {
    if (side.cuts.empty()) return side.start;
    const auto& motions = side.read->interpretation->motions;
    return motions[side.cuts.back().motion].piece.end();
  }

  static EventPair behind_last_of(const EventAlignment& aligned) {
    if (aligned.same.empty()) return {};
    return {aligned.same.back().before + 1, aligned.same.back().after + 1};
  }

  void find_moves(const EventAlignment& aligned, const EventPair& end) {
    Follower old_follower(old_, old_list_);
    Follower new_follower(new_, new_list_);
    EventPair next;
    const auto add = [&](const EventPair& to) {
      const SectionSide before = old_follower.move_to(to.before);
      moves_.push_back({next, to, before, new_follower.move_to(to.after)});
      next = {to.before + 1, to.after + 1};
    };
    moves_.reserve(aligned.same.size() + 1);
    for (const EventPair& same : aligned.same) add(same);
    if (aligned.complete) add(end);
  }

  // Around a gap it is not known yet whether there is anything to compare.
  void compare_ahead() {
    std::vector<Moves*> asked;
    for (Moves& moves : moves_) {
      if (moves.from == moves.to && moves.any()) asked.push_back(&moves);
    }
    if (threads_ == 1 || asked.size() < 2) return;
    parallel_for(threads_, asked.size(), [&](std::size_t i) {
      asked[i]->result = compare_section(asked[i]->before, asked[i]->after, promise_);
    });
  }

  void compare_moves(Moves& now, bool can_compare) {
    if (!can_compare) return flush_stretch();
    if (!now.result) {
      now.result =
          now.any() ? compare_section(now.before, now.after, promise_) : SectionComparison{};
    }
    if (last_ != nullptr && now.from == now.to) join_if_event_moved(*last_, now);
    flush_stretch();
    last_ = &now;
  }

  // Both sections beside an event break the tolerance, but together they keep it: the path is
  // right, and the event is at another position of it.
  void join_if_event_moved(Moves& first, Moves& second) const {
    const EventKind kind = old_event(first.to).event.kind;
    if (kind != EventKind::kWord && kind != EventKind::kText) return;
    if (first.result->violations.empty() || second.result->violations.empty()) return;
    const SectionSide before = joined(first.before, second.before);
    const SectionSide after = joined(first.after, second.after);
    if (compare_whole_path(before, after, promise_).verdict != Verdict::kProved) return;
    const double moved = first.result->violations.front().deviation_mm;
    first.result->violations = {
        moved_event_violation(old_event(first.to), new_event(first.to), moved)};
    second.result->violations.clear();
  }

  static SectionSide joined(const SectionSide& first, const SectionSide& second) {
    SectionSide both = first;
    const Cut* begin = first.cuts.empty() ? second.cuts.data() : first.cuts.data();
    both.cuts = {begin, first.cuts.size() + second.cuts.size()};
    return both;
  }

  // The section before the last one can no longer turn out to be half of a moved event.
  void flush_stretch() {
    if (last_ == nullptr) return;
    for (ComparedSection& section : last_->result->sections) add_section(std::move(section));
    std::ranges::move(last_->result->violations, std::back_inserter(result_.violations));
    last_ = nullptr;
  }

  void add_section(ComparedSection section) {
    const geometry::PathComparison& found = section.comparison;
    result_.corner_mm = std::max(result_.corner_mm, section.corner_mm);
    if (found.verdict == Verdict::kProved && found.bounds.at_most > result_.deviation_mm) {
      result_.deviation_mm = found.bounds.at_most;
      result_.deviation_line = section.old_worst_line;
    }
    result_.sections.push_back(std::move(section));
  }

  const ReadProgram& old_;
  const ReadProgram& new_;
  Promise promise_;
  bool two_languages_ = false;
  int threads_;
  ProgramEvents old_made_;
  ProgramEvents new_made_;
  const ProgramEvents& old_list_;
  const ProgramEvents& new_list_;
  Verification result_;
  std::vector<Moves> moves_;
  Moves* last_ = nullptr;  // compared, and not in the result yet
  std::string_view last_different_item_;
  geometry::Vector3 place_off_ = geometry::Vector3::Zero();  // mm, of the tool from where it stood
  std::array<bool, 3> named_ = {};  // axes, since the last event that was compared
};

// --- what the target would not run -----------------------------------------------------------

std::span<const gcode::Motion> motions_in(const ReadProgram& read, std::uint32_t first,
                                          std::uint32_t last) {
  const auto& motions = read.interpretation->motions;
  const auto begin = std::ranges::lower_bound(motions, first, {}, &gcode::Motion::block);
  const auto end = std::ranges::upper_bound(motions, last, {}, &gcode::Motion::block);
  return {begin, end};
}

bool is_same(const geometry::Arc& a, const geometry::Arc& b) {
  const auto same = [](const geometry::Point3& p, const geometry::Point3& q) {
    return (p - q).norm() <= geometry::kSamePlace;
  };
  return same(a.start, b.start) && same(a.end, b.end) && same(a.center, b.center) &&
         a.sweep * b.sweep > 0;
}

// A violation for each arc of a section that was compared which the target refuses
// (gcode/controls/arc_rules.h).
void add_refused_arcs(const ReadProgram& before, const ReadProgram& after,
                      const ComparedSection& section, const gcode::Control& target,
                      std::vector<Violation>& violations) {
  const auto is_old = [&](const geometry::Arc& arc) {
    return std::ranges::any_of(motions_in(before, section.old_first_block, section.old_last_block),
                               [&](const gcode::Motion& m) {
                                 return m.piece.arc() != nullptr && is_same(*m.piece.arc(), arc);
                               });
  };
  for (const gcode::Motion& m :
       motions_in(after, section.new_first_block, section.new_last_block)) {
    const geometry::Arc* arc = m.piece.arc();
    if (arc == nullptr) continue;
    const auto& meaning = after.interpretation->blocks[m.block];
    const gcode::Units units = after.interpretation->states[meaning.state_after].units;
    const std::string_view why = gcode::arc_refusal(target, *arc, units);
    if (why.empty() || is_old(*arc)) continue;
    const std::string message =
        fmt::format("{} refuses this arc: {}; expected one that it runs", target.name, why);
    violations.push_back({ViolationKind::kTarget, "arc-refused", section.old_first_line,
                          after.program->blocks[m.block].line, 0, message});
  }
}

// The blocks whose lines are too long, with their text.
std::map<std::string_view, const gcode::Block*> long_lines(const ReadProgram& read,
                                                           const gcode::Control& target) {
  std::map<std::string_view, const gcode::Block*> found;
  for (const gcode::Block& block : read.program->blocks) {
    if (block.span.size() <= target.max_line_length) continue;
    const std::string_view line = read.program->source.text(block.span);
    if (line_length(target, line) > target.max_line_length) found.try_emplace(line, &block);
  }
  return found;
}

// A violation for each new line that is longer than the target reads.
void add_long_lines(const ReadProgram& before, const ReadProgram& after,
                    const gcode::Control& target, std::vector<Violation>& violations) {
  const auto written = long_lines(after, target);
  if (written.empty()) return;
  const auto old = long_lines(before, target);
  for (const auto& [line, block] : written) {
    if (old.contains(line)) continue;
    const std::string message =
        fmt::format("{} bytes in this line, {} reads {} at the most", line_length(target, line),
                    target.name, target.max_line_length);
    violations.push_back({ViolationKind::kTarget, "line-refused", 0, block->line, 0, message});
  }
}

bool is_in_parentheses(const gcode::Comment& comment) {
  return comment.kind == gcode::CommentKind::kParenthesis;
}

// A violation for each new text in parentheses where the target has no such comments. A program
// that has any itself was written for a control that has.
void add_foreign_comments(const ReadProgram& before, const ReadProgram& after,
                          const gcode::Control& target, std::vector<Violation>& violations) {
  if (target.comments != gcode::CommentStyle::kSemicolon) return;
  if (std::ranges::any_of(before.program->comments, is_in_parentheses)) return;
  for (const gcode::Block& block : after.program->blocks) {
    for (const gcode::Comment& comment : after.program->comments_of(block)) {
      if (!is_in_parentheses(comment)) continue;
      violations.push_back({ViolationKind::kTarget, "comment-refused", 0, block.line, 0,
                            fmt::format("{} is no comment on {}, expected one behind a semicolon",
                                        after.program->source.text(comment.span), target.name)});
    }
  }
}

constexpr std::size_t kPartBlocks = 8192;

bool is_pointless(const gcode::Word& word) { return word.without_point; }

bool is_pointed(const gcode::Word& word) {
  constexpr std::string_view kNumbers = "XYZUVWIJKRQF";
  return word.has_point && word.is_number && word.value != 0 &&
         kNumbers.find(word.letter) != std::string_view::npos;
}

bool ends_with_point(const gcode::Word& word) { return word.has_point && word.decimals == 0; }

// Calls `look(word, block)` for each length and feed but zeros, as long as it gives true.
template <typename Look>
void for_each_number(const gcode::SourceText& source, const Look& look) {
  gcode::TextCarry carry;
  const gcode::Decimals either{.pointless = gcode::PointlessNumbers::kUndeclared};
  carry.decimals = {either, gcode::Units::kUnknown};
  gcode::Diagnostics of_text;
  for (;;) {
    const std::uint32_t begin = carry.begin;
    const gcode::Program part = gcode::parse_part(source, {.blocks = kPartBlocks}, carry, of_text);
    if (part.blocks.empty()) return;
    for (const gcode::Block& block : part.blocks) {
      for (const gcode::Word& word : part.words_of(block)) {
        if ((is_pointless(word) || is_pointed(word)) && !look(word, block)) return;
      }
    }
    source.release_pages({begin, carry.begin});
  }
}

// How a program writes its lengths, or its feeds.
struct Spelling {
  bool any_point = false;
  bool any_without = false;
  bool any_bare_point = false;
  std::set<std::pair<char, double>> always_with_bare_point;
};

// Many write the ones with a point and the others without.
struct Spellings {
  Spelling lengths;
  Spelling feeds;
  Spelling& of(const gcode::Word& word) { return word.letter == 'F' ? feeds : lengths; }
};

Spellings spellings_of(const gcode::SourceText& source) {
  Spellings all;
  for_each_number(source, [&](const gcode::Word& word, const gcode::Block&) {
    Spelling& found = all.of(word);
    (word.has_point ? found.any_point : found.any_without) = true;
    if (ends_with_point(word)) found.always_with_bare_point.emplace(word.letter, word.value);
    return true;
  });
  bool any_mixed = false;
  for (Spelling* found : {&all.lengths, &all.feeds}) {
    found->any_bare_point = !found->always_with_bare_point.empty();
    any_mixed = any_mixed || (found->any_bare_point && found->any_without);
  }
  if (!any_mixed) return all;
  for_each_number(source, [&](const gcode::Word& word, const gcode::Block&) {
    if (!word.has_point) all.of(word).always_with_bare_point.erase({word.letter, word.value});
    return true;
  });
  return all;
}

bool is_other(const gcode::Word& word, const Spelling& before) {
  if (word.has_point) return ends_with_point(word) && before.any_without && !before.any_point;
  return before.any_bare_point &&
         (!before.any_without || before.always_with_bare_point.contains({word.letter, word.value}));
}

}  // namespace

Verification verify(const ReadProgram& before, const ReadProgram& after, const Promise& promise,
                    int threads) {
  if (!(promise.tolerance_mm > 0) || !std::isfinite(promise.tolerance_mm)) {
    throw std::invalid_argument(fmt::format(
        "verify: tolerance {} mm, expected a finite number above 0", promise.tolerance_mm));
  }
  Verification found = Verifier(before, after, promise, threads).run();
  if (promise.target == nullptr) return found;
  // Blocks of the old program are its own affair: they are copied.
  for (const ComparedSection& section : found.sections) {
    add_refused_arcs(before, after, section, *promise.target, found.violations);
  }
  add_long_lines(before, after, *promise.target, found.violations);
  add_foreign_comments(before, after, *promise.target, found.violations);
  return found;
}

std::optional<Violation> other_point_spelling(const gcode::SourceText& before,
                                              const gcode::SourceText& after) {
  Spellings spellings = spellings_of(before);
  std::optional<Violation> violation;
  for_each_number(after, [&](const gcode::Word& word, const gcode::Block& block) {
    if (!is_other(word, spellings.of(word))) return true;
    violation.emplace();
    violation->kind = ViolationKind::kNotProved;
    violation->id = "point-spelling";
    violation->new_line = block.line;
    violation->message = fmt::format(
        "found {} {} a decimal point, expected it {} one, as in the old program: some controls "
        "take X5. for 5 mm and X5 for 0.005 mm. Say which control it is for (--target or "
        "--source), or --decimals",
        after.text(word.span), word.has_point ? "with" : "without",
        word.has_point ? "without" : "with");
    return false;
  });
  return violation;
}

}  // namespace batten::postproc
