#include "postproc/proof/verification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "gcode/reading/part_reading.h"
#include "postproc/proof/common_events.h"
#include "postproc/proof/event_alignment.h"
#include "postproc/proof/event_violations.h"
#include "postproc/proof/refused_by_target.h"
#include "postproc/proof/section_comparison.h"
#include "postproc/system/parallel_for.h"

namespace batten::postproc {
namespace {

using geometry::Verdict;

// Follows one program from event to event and knows where the tool stands.
class Follower {
 public:
  Follower(const ReadProgram& read, const ProgramEvents& list)
      : read_(read), list_(list), line_(read.line_before) {}

  // Goes behind event `index`, or to the end. Returns the moves on the way, with all events
  // between left out.
  StretchSide move_to(std::size_t index) {
    StretchSide side = here();
    const std::size_t begin = cut_;
    for (; next_event_ < index; ++next_event_) pass(list_.events[next_event_]);
    cut_ = list_.cuts_before[index];
    side.cuts = {list_.cuts.data() + begin, cut_ - begin};
    if (index < list_.events.size()) pass(list_.events[next_event_++]);
    return side;
  }

 private:
  void pass(const ProgramEvent& event) {
    block_ = event.block;
    line_ = read_.program->blocks[event.block].line;
    // What is not understood may move the tool.
    if (event.kind == EventKind::kText && read_.interpretation->blocks[event.block].motion < 0) {
      lost_after_ = event.block;
    }
  }

  [[nodiscard]] StretchSide here() const {
    StretchSide side;
    side.read = &read_;
    side.start = place();
    side.line = line_;
    return side;
  }

  // The end of the last motion that happened before or in the block of the last event.
  [[nodiscard]] std::optional<geometry::Point3> place() const {
    if (!block_) return read_.before.place;
    const auto& motions = read_.interpretation->motions;
    const auto next = std::upper_bound(
        motions.begin(), motions.end(), *block_,
        [](std::uint32_t block, const gcode::Motion& m) { return block < m.block; });
    if (next == motions.begin()) {
      return lost_after_ ? std::nullopt : read_.before.place;
    }
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
        in_common_words_(before.program->language != after.program->language),
        threads_(threads),
        old_list_(events_of(before)),
        new_list_(events_of(after)),
        old_follower_(old_, old_list_),
        new_follower_(new_, new_list_) {}

  Verification run() {
    const EventAlignment aligned = align_events(old_list_, old_, new_list_, new_);
    find_moves(aligned);
    compare_ahead();
    EventPair next{0, 0};  // the first events not looked at yet
    for (const EventPair& same : aligned.same) {
      const bool can_compare = report_gap(next, same);
      compare_moves_before(same, can_compare,
                           next.before == same.before && next.after == same.after);
      compare_event(same);
      next = {same.before + 1, same.after + 1};
    }
    finish(next, aligned.complete);
    flush_stretch();
    merge_moved_events(violations_);
    for (Violation& violation : violations_) result_.violations.push_back(std::move(violation));
    result_.events_compared = aligned.same.size();
    return std::move(result_);
  }

 private:
  // --- events -------------------------------------------------------------------------------

  [[nodiscard]] ProgramEvents events_of(const ReadProgram& read) const {
    return in_common_words_ ? list_common_events(read) : list_events(read);
  }

  [[nodiscard]] EventSpan old_span(std::size_t begin, std::size_t end) const {
    return {{old_list_.events.data() + begin, end - begin}, &old_};
  }
  [[nodiscard]] EventSpan new_span(std::size_t begin, std::size_t end) const {
    return {{new_list_.events.data() + begin, end - begin}, &new_};
  }

  // Events up to `same` that stand in one program only. Returns whether the moves around them
  // can be compared as one path all the same.
  bool report_gap(const EventPair& next, const EventPair& same) {
    const GapReport gap =
        report_events_between(old_span(next.before, same.before), new_span(next.after, same.after));
    violations_.insert(violations_.end(), gap.violations.begin(), gap.violations.end());
    return gap.only_words;
  }

  [[nodiscard]] EventAt old_event(std::size_t index) const {
    return {old_list_.events[index], old_};
  }
  [[nodiscard]] EventAt new_event(std::size_t index) const {
    return {new_list_.events[index], new_};
  }

  void compare_event(const EventPair& same) {
    const EventAt before = old_event(same.before);
    const EventAt after = new_event(same.after);
    if (before.event.kind == EventKind::kRapid) compare_unnamed_axes(before, after);
    const std::string_view item =
        in_common_words_ ? different_in_common(before, after) : different_item(before, after);
    if (!item.empty() && item != last_different_item_) {
      violations_.push_back(state_violation(item, before, after));
    }
    last_different_item_ = item;
  }

  // A rapid starts, and stays on the axes that it does not name, where the moves before it have
  // left the tool: within the tolerance.
  void compare_unnamed_axes(const EventAt& before, const EventAt& after) {
    const auto motion_of = [](const EventAt& at) -> const gcode::Motion& {
      return at.read.interpretation->motions[static_cast<std::size_t>(at.event.motion)];
    };
    const gcode::Motion& old_motion = motion_of(before);
    const gcode::Motion& new_motion = motion_of(after);
    const double start = (old_motion.piece.start() - new_motion.piece.start()).norm();
    const double end = (old_motion.piece.end() - new_motion.piece.end()).norm();
    // Rounding of the printed decimals is far above, that of doubles far below this share.
    constexpr double kRounding = 1e-9;
    if (std::max(start, end) <= promise_.tolerance_mm * (1 + kRounding)) return;
    violations_.push_back(rapid_violation(before, after));
  }

  // --- moves --------------------------------------------------------------------------------

  struct Compared {
    StretchSide before;
    StretchSide after;
    StretchResult result;
    EventPair event;  // that ends it
    bool joins_next = false;
  };

  // The moves before a pair of events, and what comparing them gives where that was done ahead.
  struct Moves {
    StretchSide before;
    StretchSide after;
    bool gap = false;  // events between stand in one program only
    std::optional<StretchResult> result;

    [[nodiscard]] bool any() const { return !before.cuts.empty() || !after.cuts.empty(); }
  };

  void find_moves(const EventAlignment& aligned) {
    moves_.reserve(aligned.same.size() + 1);
    EventPair next{0, 0};
    for (const EventPair& same : aligned.same) {
      add_moves(next, same);
      next = {same.before + 1, same.after + 1};
    }
    if (aligned.complete) add_moves(next, {old_list_.events.size(), new_list_.events.size()});
  }

  void add_moves(const EventPair& next, const EventPair& same) {
    const bool gap = next.before != same.before || next.after != same.after;
    const StretchSide before = old_follower_.move_to(same.before);
    const StretchSide after = new_follower_.move_to(same.after);
    moves_.push_back({before, after, gap, {}});
  }

  // Around a gap it is not known yet whether there is anything to compare.
  void compare_ahead() {
    std::vector<Moves*> asked;
    for (Moves& moves : moves_) {
      if (!moves.gap && moves.any()) asked.push_back(&moves);
    }
    if (threads_ == 1 || asked.size() < 2) return;
    parallel_for(threads_, asked.size(), [&](std::size_t i) {
      asked[i]->result = compare_stretch(asked[i]->before, asked[i]->after, promise_);
    });
  }

  void compare_moves_before(const EventPair& same, bool can_compare, bool no_gap) {
    Moves& moves = moves_[next_moves_++];
    if (!can_compare) return flush_stretch();
    Compared now{moves.before, moves.after, {}, same, false};
    if (moves.result) {
      now.result = std::move(*moves.result);
    } else if (moves.any()) {
      now.result = compare_stretch(moves.before, moves.after, promise_);
    }
    if (no_gap && last_ && last_->joins_next) join_if_event_moved(*last_, now);
    flush_stretch();
    now.joins_next =
        same.before < old_list_.events.size() && may_move(old_list_.events[same.before].kind);
    last_ = std::move(now);
  }

  static bool may_move(EventKind kind) {
    return kind == EventKind::kWord || kind == EventKind::kText;
  }

  // Both stretches beside an event break the tolerance, but together they keep it: the path is
  // right, and the event stands at another place of it.
  void join_if_event_moved(Compared& first, Compared& second) const {
    if (first.result.violations.empty() || second.result.violations.empty()) return;
    const StretchSide before = joined(first.before, second.before);
    const StretchSide after = joined(first.after, second.after);
    if (compare_whole_path(before, after, promise_).verdict != Verdict::kProved) return;
    const double moved = first.result.violations.front().deviation_mm;
    first.result.violations = {
        moved_event_violation(old_event(first.event.before), new_event(first.event.after), moved)};
    second.result.violations.clear();
  }

  static StretchSide joined(const StretchSide& first, const StretchSide& second) {
    StretchSide both = first;
    const Cut* begin = first.cuts.empty() ? second.cuts.data() : first.cuts.data();
    both.cuts = {begin, first.cuts.size() + second.cuts.size()};
    return both;
  }

  // The stretch before the last one can no longer turn out to be half of a moved event.
  void flush_stretch() {
    if (!last_) return;
    for (Stretch& stretch : last_->result.stretches) add_stretch(std::move(stretch));
    for (Violation& violation : last_->result.violations)
      violations_.push_back(std::move(violation));
    last_.reset();
  }

  void add_stretch(Stretch stretch) {
    const geometry::PathComparison& found = stretch.comparison;
    result_.corner_mm = std::max(result_.corner_mm, stretch.corner_mm);
    if (found.verdict == Verdict::kProved && found.bounds.at_most > result_.deviation_mm) {
      result_.deviation_mm = found.bounds.at_most;
      result_.deviation_line = stretch.old_worst_line;
    }
    result_.stretches.push_back(std::move(stretch));
  }

  // --- end ----------------------------------------------------------------------------------

  void finish(const EventPair& next, bool complete) {
    if (!complete) {
      flush_stretch();
      violations_.push_back(too_many_differences(old_span(next.before, old_list_.events.size()),
                                                 new_span(next.after, new_list_.events.size())));
      return;
    }
    const EventPair end{old_list_.events.size(), new_list_.events.size()};
    const bool no_gap = next.before == end.before && next.after == end.after;
    const bool can_compare = report_gap(next, end);
    compare_moves_before(end, can_compare, no_gap);
    // The end of a program of another language leaves behind what that control leaves.
    if (in_common_words_) return;
    const std::string_view item = different_item_at_end(old_, new_);
    if (!item.empty() && item != last_different_item_) {
      violations_.push_back(end_state_violation(item, old_, new_));
    }
  }

  const ReadProgram& old_;
  const ReadProgram& new_;
  Promise promise_;
  bool in_common_words_ = false;  // the programs are of two languages
  int threads_;
  ProgramEvents old_list_;
  ProgramEvents new_list_;
  Follower old_follower_;
  Follower new_follower_;
  Verification result_;
  std::vector<Violation> violations_;
  std::vector<Moves> moves_;  // one for each pair of events that are the same, and behind them
  std::size_t next_moves_ = 0;
  std::optional<Compared> last_;
  std::string_view last_different_item_;
};

}  // namespace

Verification verify(const ReadProgram& before, const ReadProgram& after, const Promise& promise,
                    int threads) {
  if (!(promise.tolerance_mm > 0) || !std::isfinite(promise.tolerance_mm)) {
    throw std::invalid_argument(fmt::format(
        "verify: tolerance {} mm, expected a finite number above 0", promise.tolerance_mm));
  }
  Verification found = Verifier(before, after, promise, threads).run();
  if (promise.target != nullptr) {
    std::ranges::move(refused_by_target(before, after, found.stretches, *promise.target),
                      std::back_inserter(found.violations));
  }
  return found;
}

namespace {

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
