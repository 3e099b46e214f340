#include "postproc/proof/program_events.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "gcode/state/block_words.h"
#include "gcode/state/code_table.h"
#include "gcode/state/modal_state.h"
#include "gcode/state/reason.h"
#include "gcode/text/characters.h"

namespace batten::postproc {
namespace {

using gcode::Block;
using gcode::BlockKind;
using gcode::BlockMeaning;
using gcode::Code;
using gcode::CodeGroup;
using gcode::Motion;
using gcode::MotionKind;
using gcode::Word;
namespace reason = gcode::reason;

// "G 1" is G1 and "g1" too: blanks and case mean nothing inside a word.
void append_word(std::string& text, std::string_view word) {
  for (const char c : word) {
    if (!gcode::is_blank(c)) text += gcode::upper(c);
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

// Capital letters, as bits: a search in text would be a call for each word.
consteval std::uint32_t set_of(std::string_view letters) {
  std::uint32_t bits = 0;
  for (const char c : letters) bits |= 1U << static_cast<unsigned>(c - 'A');
  return bits;
}

class ProgramLister : EventLister {
 public:
  explicit ProgramLister(const ReadProgram& read) : EventLister(read), read_(read) {
    set_by_word_ = read.before.set_by_word;
    feed_is_new_ = read.before.feed_is_new;
  }

  ProgramEvents run() {
    list_.cuts.reserve(interpretation_.motions.size());
    std::span<const std::uint32_t> ends = read_.cuts;  // that are still ahead; never block 0
    for (block_index_ = 0; block_index_ < program_.blocks.size(); ++block_index_) {
      if (!ends.empty() && ends.front() == block_index_) {
        ends = ends.subspan(1);
        add_event(EventKind::kCut).block = block_index_ - 1;  // it is after the block before it
      }
      const std::size_t cuts = list_.cuts.size();
      const Block& block = program_.blocks[block_index_];
      list_block(block, interpretation_.blocks[block_index_]);
      feed_is_new_ = (feed_is_new_ || names_feed(block)) && list_.cuts.size() == cuts;
    }
    list_.cuts_before.push_back(list_.cuts.size());
    list_.at_end = {set_by_word_, last_end(), feed_is_new_};
    return std::move(list_);
  }

  [[nodiscard]] bool is_plain_rapid(std::uint32_t index) {
    block_index_ = index;
    const Block& block = program_.blocks[index];
    const BlockMeaning& meaning = interpretation_.blocks[index];
    if (meaning.barrier != reason::kRapid || meaning.motion < 0 || meaning.of_curve) return false;
    if (block.opacity != gcode::ParseStatus::kNone || block.block_delete) return false;
    const auto is_plain = [](const Word& word) {
      return is_one_of(set_of("NGXYZF"), word) && (word.letter != 'G' || word.value == 0);
    };
    return std::ranges::all_of(program_.words_of(block), is_plain) &&
           !must_be_kept_as_text(block, meaning);
  }

 private:
  void list_block(const Block& block, const BlockMeaning& meaning) {
    if (meaning.of_curve) {
      // What the interpreter follows exactly, it follows only where the path alone counts.
      for (const Motion& motion : gcode::motions_of(interpretation_, block_index_)) {
        add_cut(motion, state_after().feed_without_point);
      }
      return;
    }
    if (block.opacity != gcode::ParseStatus::kNone || block.block_delete) {
      // The same letters can be words in the other program: a CR alone divides no line there.
      const bool unreadable = block.opacity == gcode::ParseStatus::kUnreadable;
      add_text((unreadable ? "unreadable " : "") + text_of_block(block));
    } else {
      list_active_comments(block);  // a message comes before the motion of its block
      list_words(block, meaning);
    }
    forget_words(block);
  }

  void forget_words(const Block& block) {
    // Its names may have changed any group. Where nothing is known any more, no word is a
    // repetition.
    if (block.opacity == gcode::ParseStatus::kNamedWords ||
        state_after().distance == gcode::DistanceMode::kUnknown) {
      set_by_word_.fill(kNotSet);
    }
  }

  [[nodiscard]] std::optional<geometry::Point3> last_end() const {
    if (interpretation_.motions.empty()) return read_.before.place;
    const Motion& last = interpretation_.motions.back();
    return last.end_known ? std::optional(last.piece.end()) : std::nullopt;
  }

  // --- words --------------------------------------------------------------------------------

  static bool is_one_of(std::uint32_t letters, const Word& word) {
    const auto letter = static_cast<unsigned>(word.letter - 'A');  // above 25: it is none
    return letter <= 'Z' - 'A' && (letters >> letter & 1U) != 0;
  }

  [[nodiscard]] bool names_feed(const Block& block) const {
    return std::ranges::any_of(program_.words_of(block),
                               [](const Word& word) { return word.letter == 'F'; });
  }

  void list_words(const Block& block, const BlockMeaning& meaning) {
    if (must_be_kept_as_text(block, meaning)) {
      remember_words(block);
      std::string text = text_of_words(block, meaning.label_referenced);
      if (!text.empty()) add_text(std::move(text));
      return;
    }
    const bool moves = meaning.motion >= 0;
    acts_with_motion_ = false;
    for (const bool stops : {false, true}) {  // the program stops when its block is done
      for (const Word& word : program_.words_of(block)) {
        if (is_stop(word) == stops) list_word(block, word, moves);
      }
    }
    if (!moves) return;
    if (!add_motion(meaning, state_after().feed_without_point) && !state_after().feed) {
      EventLister::add_word("cut to nowhere before the first feed");  // refused, or not
    }
    if (motion_of(meaning).kind == MotionKind::kRapid) {
      list_.events.back().feed_is_new |= names_feed(block);
    }
    // Controls differ in whether such a word acts before or after the motion of its block:
    // both ends of the motion must stay.
    if (acts_with_motion_) EventLister::add_word("end of motion with words");
  }

  [[nodiscard]] bool must_be_kept_as_text(const Block& block, const BlockMeaning& meaning) const {
    if (meaning.kind == BlockKind::kOpaque || meaning.label_referenced ||
        meaning.entered_from_elsewhere || !can_be_said_in_words(meaning.barrier)) {
      return true;
    }
    const bool moves = meaning.motion >= 0;
    for (const Word& word : program_.words_of(block)) {
      if (!can_stand_alone(word, moves)) return true;
    }
    if (!moves) return false;
    const Motion& motion = motion_of(meaning);
    return !motion.start_known || !motion.end_known || !path_alone_counts(state_after());
  }

  // Does the word mean what it means without its neighbours? X of a line does, X of G28 not.
  static bool can_stand_alone(const Word& word, bool moves) {
    constexpr double kFirstOfTheUser = 100;  // what they run is not known
    if (!word.is_number) return false;
    if (is_one_of(set_of("XYZIJKR"), word)) return moves;
    if (word.letter == 'G') {
      return gcode::row_of_g(gcode::code_of(word)).is(gcode::trait::kStandsAlone);
    }
    if (word.letter == 'M') return word.value < kFirstOfTheUser;
    return is_one_of(set_of("NFSTDH"), word);
  }

  static bool is_stop(const Word& word) {
    return word.letter == 'M' && word.is_number &&
           gcode::row_of_m(gcode::code_of(word)).group == CodeGroup::kStop;
  }

  void list_word(const Block& block, const Word& word, bool moves) {
    if (word.letter == 'G') return list_g(block, word, moves);
    const auto& before = interpretation_.states[state_index_before()];
    const bool acts = word.letter == 'S' ? before.spindle_speed != word.value
                      // No state carries it to the position where it counts.
                      : word.letter == 'F' ? !state_after().feed
                      // Controls refuse what is no number of a block, or run it.
                      : word.letter == 'N' ? !gcode::is_block_number(program_, block, word)
                                           : is_one_of(set_of("MTDH"), word);
    if (acts) add_word(word, moves);
  }

  // What such a block sets may be there for the next program: controls differ in what they reset.
  [[nodiscard]] bool ends_program(const Block& block) const {
    return std::ranges::any_of(program_.words_of(block), [](const Word& word) {
      return word.letter == 'M' && word.is_number &&
             gcode::row_of_m(gcode::code_of(word)).act == gcode::CodeAct::kEnds;
    });
  }

  void list_g(const Block& block, const Word& word, bool moves) {
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
    // Compared as states, wherever something depends on them.
    const bool is_state = row.group == CodeGroup::kPlane || row.group == CodeGroup::kArcDistance;
    if (repeats || (is_state && !ends_program(block))) return;
    add_word(word, moves);
  }

  // A block that is kept as text sets modes too. Motions are compared as such. Where words exclude
  // each other, which of them count is not known, and none that is said again repeats one.
  void remember_words(const Block& block) {
    const gcode::BlockWords words(program_.words_of(block));
    const bool refused = words.problem() != gcode::BlockWords::Problem::kNone;
    for (const Word& word : program_.words_of(block)) {
      if (word.letter != 'G') continue;
      const gcode::CodeRow& row = gcode::row_of_g(gcode::code_of(word));
      if (row.group != CodeGroup::kMotion) {
        set_by_word_[static_cast<std::size_t>(row.group)] = refused ? kNotSet : row.code;
      }
    }
  }

  [[nodiscard]] std::string text_of_words(const Block& block, bool with_label) const {
    std::string text;
    for (const Word& word : program_.words_of(block)) {
      if (with_label || !gcode::is_block_number(program_, block, word)) {
        append_word(text, program_.source.text(word.span));
      }
    }
    return text;
  }

  // Controls number the blocks of Klartext anew, so the number is left out there. A centre in an
  // earlier block is a part of what this one says.
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

  void add_word(const Word& word, bool moves) {
    std::string text;
    append_word(text, program_.source.text(word.span));
    if (moves) text += " with motion";
    acts_with_motion_ |= moves;
    EventLister::add_word(std::move(text));
  }

  static constexpr Code kNotSet = -1;

  const ReadProgram& read_;
  bool acts_with_motion_ = false;
};

}  // namespace

ProgramEvent& EventLister::add_event(EventKind kind) {
  list_.cuts_before.push_back(list_.cuts.size());
  ProgramEvent& event = list_.events.emplace_back();
  event.kind = kind;
  event.block = block_index_;
  event.state_before = state_index_before();
  const auto is_set = [this](CodeGroup group) {
    return set_by_word_[static_cast<std::size_t>(group)] >= 0;
  };
  event.plane_set = is_set(CodeGroup::kPlane);
  event.arc_distance_set = is_set(CodeGroup::kArcDistance);
  event.feed_is_new = feed_is_new_;
  return event;
}

void EventLister::add_cut(const Motion& motion, bool feed_without_point) {
  const auto index = static_cast<std::uint32_t>(&motion - interpretation_.motions.data());
  list_.cuts.push_back({state_after().feed, index, feed_without_point});
}

bool EventLister::add_motion(const BlockMeaning& meaning, bool feed_without_point) {
  const Motion& motion = motion_of(meaning);
  if (motion.kind == MotionKind::kRapid) {
    add_event(EventKind::kRapid).motion = meaning.motion;
    return true;
  }
  if (!goes_on(motion)) return false;
  add_cut(motion, feed_without_point);
  return true;
}

bool same_feed(const std::optional<double>& a, const std::optional<double>& b) {
  constexpr double kPrinted = 1e-6;
  if (!a || !b) return a.has_value() == b.has_value();
  return std::abs(*a - *b) <= kPrinted * std::max(std::abs(*a), std::abs(*b));
}

bool same_feed(const Cut& a, const Cut& b) {
  return same_feed(a.feed, b.feed) && a.feed_without_point == b.feed_without_point;
}

bool is_one_feed(const Cut& a, const Cut& b) {
  return a.feed == b.feed && a.feed_without_point == b.feed_without_point;
}

ProgramEvents list_events(const ReadProgram& read) { return ProgramLister(read).run(); }

EventsBefore events_before_next(const ReadProgram& read) { return list_events(read).at_end; }

bool is_plain_rapid(const ReadProgram& read, std::uint32_t block) {
  return ProgramLister(read).is_plain_rapid(block);
}

}  // namespace batten::postproc
