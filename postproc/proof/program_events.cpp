#include "postproc/proof/program_events.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gcode/state/code_table.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"

namespace batten::postproc {
namespace {

using gcode::Block;
using gcode::BlockKind;
using gcode::BlockMeaning;
using gcode::Code;
using gcode::CodeGroup;
using gcode::ModalState;
using gcode::Motion;
using gcode::MotionKind;
using gcode::TriState;
using gcode::Word;
namespace reason = gcode::reason;

// "G 1" is G1 and "g1" too: blanks and case mean nothing inside a word.
void append_word(std::string& text, std::string_view word) {
  for (const char c : word) {
    if (c == ' ' || c == '\t') continue;
    text += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  }
}

// Barriers of blocks that can be said word by word.
bool can_be_said_in_words(std::string_view barrier) {
  constexpr std::array kOurs = {
      std::string_view{},  reason::kRapid,         reason::kArc,          reason::kStateChange,
      reason::kSpindle,    reason::kCoolant,       reason::kMiscFunction, reason::kToolChange,
      reason::kProgramEnd, reason::kActiveComment, reason::kCannedCycle,  reason::kCoordinateChange,
      reason::kExactStop,
  };
  return std::ranges::find(kOurs, barrier) != kOurs.end();
}

bool has_length(const gcode::MotionPath& path) {
  return !path.is_line() || path.start() != path.end();
}

class Lister {
 public:
  explicit Lister(const ReadProgram& read)
      : program_(*read.program),
        interpretation_(*read.interpretation),
        cuts_(read.cuts),
        set_by_word_(read.before.set_by_word),
        feed_is_new_(read.before.feed_is_new) {}

  ProgramEvents run() {
    list_.cuts.reserve(interpretation_.motions.size());
    for (std::uint32_t i = 0; i < program_.blocks.size(); ++i) {
      if (!cuts_.empty() && cuts_.front() == i) list_cut(i);
      const std::size_t cuts = list_.cuts.size();
      list_block(i);
      if (names_feed(program_.blocks[i])) feed_is_new_ = true;
      if (list_.cuts.size() > cuts) feed_is_new_ = false;
    }
    list_.cuts_before.push_back(list_.cuts.size());
    return std::move(list_);
  }

  // The words that are set at the end, without a list of events.
  std::array<Code, kCodeGroups> words_set() {
    for (block_index_ = 0; block_index_ < program_.blocks.size(); ++block_index_) {
      const Block& block = program_.blocks[block_index_];
      if (interpretation_.blocks[block_index_].of_curve) continue;
      if (block.opacity == gcode::ParseStatus::kNone && !block.block_delete) remember_words(block);
      forget_words_in_unknown_state();
    }
    return set_by_word_;
  }

  [[nodiscard]] bool feed_is_new_at_end() {
    for (std::size_t i = program_.blocks.size(); i-- > 0;) {
      if (is_cut(static_cast<std::uint32_t>(i))) return false;
      if (names_feed(program_.blocks[i])) return true;
    }
    return feed_is_new_;
  }

  [[nodiscard]] bool is_plain_rapid(std::uint32_t index) {
    block_index_ = index;
    const Block& block = program_.blocks[index];
    const BlockMeaning& meaning = interpretation_.blocks[index];
    if (meaning.barrier != reason::kRapid || meaning.motion < 0 || meaning.of_curve) return false;
    if (block.opacity != gcode::ParseStatus::kNone || block.block_delete) return false;
    constexpr std::string_view kLetters = "NGXYZF";
    const auto is_plain = [&](const Word& word) {
      return kLetters.find(word.letter) != std::string_view::npos &&
             (word.letter != 'G' || word.value == 0);
    };
    return std::ranges::all_of(program_.words_of(block), is_plain) &&
           !must_stand_as_text(block, meaning);
  }

 private:
  // It stands behind the block before it.
  void list_cut(std::uint32_t index) {
    cuts_ = cuts_.subspan(1);
    block_index_ = index;
    add_event(EventKind::kCut).block = index - 1;
  }

  void list_block(std::uint32_t index) {
    block_index_ = index;
    const Block& block = program_.blocks[index];
    const BlockMeaning& meaning = interpretation_.blocks[index];
    if (meaning.of_curve) {
      // What the interpreter follows exactly, it follows only where the path alone counts.
      if (meaning.motion >= 0) add_cut(meaning);
      return;
    }
    if (block.opacity != gcode::ParseStatus::kNone || block.block_delete) {
      add_text(text_of_block(block));
      // Its names may have changed any group.
      if (block.opacity == gcode::ParseStatus::kNamedWords) set_by_word_.fill(kNotSet);
    } else {
      list_words(block, meaning);
      list_active_comments(block);
    }
    forget_words_in_unknown_state();
  }

  // Where nothing is known any more, no word is a repetition.
  void forget_words_in_unknown_state() {
    if (state_after().distance == gcode::DistanceMode::kUnknown) set_by_word_.fill(kNotSet);
  }

  // --- words --------------------------------------------------------------------------------

  void list_words(const Block& block, const BlockMeaning& meaning) {
    if (must_stand_as_text(block, meaning)) {
      remember_words(block);
      std::string text = text_of_words(block, meaning.label_referenced);
      if (!text.empty()) add_text(std::move(text));
      return;
    }
    for (const Word& word : program_.words_of(block)) {
      if (word.letter != 'N' || is_block_number(block, word)) {
        list_word(word, meaning.motion >= 0);
      } else {
        add_word(word, meaning.motion >= 0);  // controls refuse it, or run it
      }
    }
    if (meaning.motion < 0) return;
    const Motion& motion = interpretation_.motions[static_cast<std::size_t>(meaning.motion)];
    if (motion.kind == MotionKind::kRapid) {
      ProgramEvent& event = add_event(EventKind::kRapid);
      event.motion = meaning.motion;
    } else if (has_length(motion.piece)) {
      add_cut(meaning);
    } else if (!state_after().feed) {
      add_event(EventKind::kWord).text = "cut to nowhere before the first feed";  // refused, or not
    }
    if (acts_with_motion_) {
      // Controls differ in whether such a word acts before or after the motion of its block:
      // both ends of the motion are places that must stay.
      add_event(EventKind::kWord).text = "end of motion with words";
      acts_with_motion_ = false;
    }
  }

  [[nodiscard]] bool names_feed(const Block& block) const {
    return std::ranges::any_of(program_.words_of(block),
                               [](const Word& word) { return word.letter == 'F'; });
  }

  // Does list_block give a cut?
  [[nodiscard]] bool is_cut(std::uint32_t index) {
    block_index_ = index;
    const Block& block = program_.blocks[index];
    const BlockMeaning& meaning = interpretation_.blocks[index];
    if (meaning.motion < 0 || meaning.of_curve) return meaning.motion >= 0;
    const Motion& motion = interpretation_.motions[static_cast<std::size_t>(meaning.motion)];
    return block.opacity == gcode::ParseStatus::kNone && !block.block_delete &&
           motion.kind != MotionKind::kRapid && has_length(motion.piece) &&
           !must_stand_as_text(block, meaning);
  }

  void add_cut(const BlockMeaning& meaning) {
    list_.cuts.push_back({static_cast<std::uint32_t>(meaning.motion), state_after().feed,
                          state_after().feed_without_point});
  }

  [[nodiscard]] bool must_stand_as_text(const Block& block, const BlockMeaning& meaning) const {
    if (meaning.kind == BlockKind::kOpaque || meaning.label_referenced ||
        meaning.entered_from_elsewhere || !can_be_said_in_words(meaning.barrier)) {
      return true;
    }
    const bool moves = meaning.motion >= 0;
    for (const Word& word : program_.words_of(block)) {
      if (!can_stand_alone(word, moves)) return true;
    }
    if (!moves) return false;
    const Motion& motion = interpretation_.motions[static_cast<std::size_t>(meaning.motion)];
    return !motion.start_known || !motion.end_known || !path_alone_counts_here();
  }

  // States are shared by many blocks: asked once for each.
  [[nodiscard]] bool path_alone_counts_here() const {
    const std::uint32_t state = interpretation_.blocks[block_index_].state_after;
    if (asked_state_ != state) {
      asked_state_ = state;
      answer_ = path_alone_counts(interpretation_.states[state]);
    }
    return answer_;
  }

  // Does the word mean what it means without its neighbours? X of a line does, X of G28 not.
  static bool can_stand_alone(const Word& word, bool moves) {
    if (!word.is_number) return false;
    switch (word.letter) {
      case 'N':
      case 'F':
      case 'S':
      case 'T':
      case 'D':
      case 'H':
        return true;
      case 'M': {
        constexpr double kFirstOfTheUser = 100;  // what they run is not known
        return word.value < kFirstOfTheUser;
      }
      case 'X':
      case 'Y':
      case 'Z':
      case 'I':
      case 'J':
      case 'K':
      case 'R':
        return moves;
      case 'G':
        return gcode::row_of_g(gcode::code_of(word)).is(gcode::trait::kStandsAlone);
      default:
        return false;
    }
  }

  void list_word(const Word& word, bool moves) {
    switch (word.letter) {
      case 'G':
        return list_g(word, moves);
      case 'S':
        if (state_before().spindle_speed == word.value) return;
        return add_word(word, moves);
      case 'M':
      case 'T':
      case 'D':
      case 'H':
        return add_word(word, moves);
      case 'F':
        // No state carries it to the place where it counts.
        if (!state_after().feed) add_word(word, moves);
        return;
      default:
        return;
    }
  }

  void list_g(const Word& word, bool moves) {
    const gcode::CodeRow& row = gcode::row_of_g(gcode::code_of(word));
    if (row.group == CodeGroup::kMotion) {
      // To nowhere: controls refuse an arc, or run it, and refuse a cut before the first feed.
      const auto mode = row.value.as<gcode::MotionMode>();
      const bool cut_without_feed = mode == gcode::MotionMode::kLine && !state_after().feed;
      if (!moves && (gcode::is_arc(mode) || cut_without_feed)) add_word(word, moves);
      return;
    }
    Code& set = set_by_word_[static_cast<std::size_t>(row.group)];
    const bool repeats = set == row.code && !row.is(gcode::trait::kActsEachTime);
    set = row.code;
    if (repeats || row.group == CodeGroup::kPlane || row.group == CodeGroup::kArcDistance) return;
    add_word(word, moves);
  }

  // A block that stands as text sets modes too.
  void remember_words(const Block& block) {
    for (const Word& word : program_.words_of(block)) {
      if (word.letter != 'G') continue;
      const gcode::CodeRow& row = gcode::row_of_g(gcode::code_of(word));
      set_by_word_[static_cast<std::size_t>(row.group)] = row.code;
    }
  }

  [[nodiscard]] std::string text_of_words(const Block& block, bool with_label) const {
    std::string text;
    for (const Word& word : program_.words_of(block)) {
      if (with_label || !is_block_number(block, word)) {
        append_word(text, program_.source.text(word.span));
      }
    }
    return text;
  }

  // An N behind other words or a comment is no block number on all controls, nor is N-1.
  [[nodiscard]] bool is_block_number(const Block& block, const Word& word) const {
    const auto stands_before = [&](const auto& other) {
      return other.span.begin >= block.span.begin && other.span.begin < word.span.begin;
    };
    return word.letter == 'N' && is_unsigned(program_.source.text(word.span)) &&
           std::ranges::none_of(program_.words_of(block), stands_before) &&
           std::ranges::none_of(program_.comments_of(block), stands_before);
  }

  static bool is_unsigned(std::string_view number) {
    return number.find_first_of("+-") == std::string_view::npos;
  }

  // Controls number the blocks of Klartext anew, so the number is left out there. A centre that
  // stands in an earlier block is a part of what this one says.
  [[nodiscard]] std::string text_of_block(const Block& block) const {
    gcode::SourceSpan span = block.span;
    if (program_.language != gcode::Language::kKlartext) {
      return std::string(program_.source.text(span));
    }
    std::string from_elsewhere;
    for (const Word& word : program_.words_of(block)) {
      if (word.letter == 'N') span.begin = word.span.end;
      if (word.span.begin < block.span.begin) {
        append_word(from_elsewhere, program_.source.text(word.span));
      }
    }
    std::string text(program_.source.text(span));
    if (block.block_delete) text += " hidden";
    if (!from_elsewhere.empty()) text += " about " + from_elsewhere;
    return text;
  }

  void list_active_comments(const Block& block) {
    for (const gcode::Comment& comment : program_.comments_of(block)) {
      if (comment.kind == gcode::CommentKind::kActive ||
          comment.kind == gcode::CommentKind::kUncertain) {
        add_text(std::string(program_.source.text(comment.span)));
      }
    }
  }

  // --- events -------------------------------------------------------------------------------

  void add_word(const Word& word, bool moves) {
    ProgramEvent& event = add_event(EventKind::kWord);
    append_word(event.text, program_.source.text(word.span));
    if (moves) {
      event.text += " with motion";
      acts_with_motion_ = true;
    }
  }

  void add_text(std::string text) { add_event(EventKind::kText).text = std::move(text); }

  ProgramEvent& add_event(EventKind kind) {
    ProgramEvent event;
    event.kind = kind;
    event.block = block_index_;
    event.state_before = state_index_before();
    event.plane_set = is_set(CodeGroup::kPlane);
    event.arc_distance_set = is_set(CodeGroup::kArcDistance);
    event.feed_is_new = feed_is_new_;
    if (kind == EventKind::kRapid) {
      event.feed_is_new |= names_feed(program_.blocks[block_index_]);
    }
    list_.cuts_before.push_back(list_.cuts.size());
    list_.events.push_back(std::move(event));
    return list_.events.back();
  }

  [[nodiscard]] bool is_set(CodeGroup group) const {
    return set_by_word_[static_cast<std::size_t>(group)] != kNotSet;
  }
  [[nodiscard]] std::uint32_t state_index_before() const {
    return block_index_ > 0 ? interpretation_.blocks[block_index_ - 1].state_after : 0;
  }
  [[nodiscard]] const ModalState& state_before() const {
    return interpretation_.states[state_index_before()];
  }
  [[nodiscard]] const ModalState& state_after() const {
    return interpretation_.states[interpretation_.blocks[block_index_].state_after];
  }

  static constexpr Code kNotSet = -1;

  const gcode::Program& program_;
  const gcode::Interpretation& interpretation_;
  std::span<const std::uint32_t> cuts_;  // that are still ahead; never block 0
  ProgramEvents list_;
  std::uint32_t block_index_ = 0;
  std::array<Code, kCodeGroups> set_by_word_;  // the last word of each group
  bool feed_is_new_;                           // before the block that is listed
  bool acts_with_motion_ = false;
  mutable std::optional<std::uint32_t> asked_state_;
  mutable bool answer_ = false;
};

}  // namespace

bool same_feed(const std::optional<double>& a, const std::optional<double>& b) {
  constexpr double kPrinted = 1e-6;
  if (!a || !b) return a.has_value() == b.has_value();
  return std::abs(*a - *b) <= kPrinted * std::max(std::abs(*a), std::abs(*b));
}

bool same_feed(const Cut& a, const Cut& b) {
  return same_feed(a.feed, b.feed) && a.feed_without_point == b.feed_without_point;
}

ProgramEvents list_events(const ReadProgram& read) { return Lister(read).run(); }

bool feed_is_new_at_end(const ReadProgram& read) { return Lister(read).feed_is_new_at_end(); }

bool is_plain_rapid(const ReadProgram& read, std::uint32_t block) {
  return Lister(read).is_plain_rapid(block);
}

EventsBefore events_before_next(const ReadProgram& read) {
  EventsBefore next;
  next.set_by_word = Lister(read).words_set();
  next.feed_is_new = feed_is_new_at_end(read);
  next.place = read.before.place;
  const auto& motions = read.interpretation->motions;
  if (motions.empty()) return next;
  const Motion& last = motions.back();
  if (last.end_known) next.place = geometry::end_point(last.piece);
  if (!last.end_known) next.place.reset();
  return next;
}

}  // namespace batten::postproc
