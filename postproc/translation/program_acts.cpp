#include "postproc/translation/program_acts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "gcode/block_words.h"
#include "postproc/profile/profile_words.h"
#include "postproc/proof/path_state.h"

namespace batten::postproc {
namespace {

using gcode::Block;
using gcode::BlockMeaning;
using gcode::Motion;
using gcode::MotionKind;
using gcode::Word;

// In tenths: words that only say how others are read, which the interpreter has followed, or that
// end what was refused where it began.
constexpr std::array kSilentG = {0,   10,  20,  30,  170, 180, 190, 200, 210, 400,
                                 800, 900, 901, 910, 911, 940, 970, 980, 990};
constexpr std::array kPlainM = {0, 10, 20, 30, 40, 50, 60, 80, 90, 300};
constexpr int kToolLengthOn = 430;
constexpr int kToolLengthOff = 490;
constexpr int kBlending = 640;
constexpr std::string_view kKnownLetters = "NGMXYZIJKRFSTH";
constexpr std::string_view kPlaceLetters = "XYZIJKR";
constexpr std::string_view kArcLetters = "IJKR";

template <std::size_t count>
bool is_in(const std::array<int, count>& codes, int code) {
  return std::ranges::find(codes, code) != codes.end();
}

bool is_work_offset(int code) { return code >= 540 && code <= 590 && code % 10 == 0; }

std::string_view without_brackets(std::string_view comment) {
  if (comment.starts_with('(')) {
    comment.remove_prefix(1);
    if (comment.ends_with(')')) comment.remove_suffix(1);
  } else if (comment.starts_with(';')) {
    comment.remove_prefix(1);
  }
  while (comment.starts_with(' ')) comment.remove_prefix(1);
  while (comment.ends_with(' ')) comment.remove_suffix(1);
  return comment;
}

// Whether something is on, off, or not known: not set by the program.
using Known = std::optional<bool>;

class ActReader {
 public:
  ActReader(const gcode::Program& program, const gcode::Interpretation& meaning)
      : program_(program), meaning_(meaning) {}

  ProgramActs read() {
    for (std::uint32_t i = 0; i < program_.blocks.size(); ++i) read_block(i);
    return std::move(result_);
  }

 private:
  void read_block(std::uint32_t index) {
    block_ = index;
    told_ = false;
    const Block& block = program_.blocks[index];
    add_comments(block);
    if (block.opacity == gcode::Opacity::kProgramMark) return;
    const std::span<const Word> words = program_.words_of(block);
    const bool says_nothing =
        std::ranges::all_of(words, [](const Word& word) { return word.letter == 'N'; });
    if (const std::string_view why = why_not_plain(block); !why.empty()) {
      return refuse(block.span, std::string(why));
    }
    if (says_nothing) return;
    if (ended_) return refuse(block.span, "stands behind the end of the program");
    for (const Word& word : words) {
      if (std::string why = why_not(word, words); !why.empty()) refuse(word.span, std::move(why));
    }
    if (!told_) add_acts(words, meaning_.blocks[index]);
  }

  void refuse(gcode::SourceSpan where, std::string why) {
    if (!std::exchange(told_, true)) result_.obstacles.push_back({where, std::move(why)});
  }

  // --- what can be said ---------------------------------------------------------------------

  [[nodiscard]] std::string_view why_not_plain(const Block& block) const {
    const BlockMeaning& meaning = meaning_.blocks[block_];
    if (block.block_delete) return "is left out by some controls, run by others";
    if (block.has_checksum) return "has a check sum";
    if (block.opacity != gcode::Opacity::kNone) return "is no block of plain words";
    if (meaning.label_referenced || meaning.entered_from_elsewhere) return "is jumped to";
    if (meaning.kind == gcode::BlockKind::kOpaque) return "is not understood";
    return {};
  }

  [[nodiscard]] std::string why_not(const Word& word, std::span<const Word> words) const {
    if (!word.is_number) return "has no plain number";
    switch (word.letter) {
      case 'G':
        return why_not_g(tenths_of(word), words);
      case 'M':
        return is_in(kPlainM, tenths_of(word)) ? "" : "may mean something else there";
      case 'H':
        return has_g(words, kToolLengthOn) ? "" : "may mean something else there";
      case 'T':
        return word.value >= 1 && word.value == std::floor(word.value) ? "" : "is no tool there";
      default:
        break;
    }
    if (kKnownLetters.find(word.letter) == std::string_view::npos) {
      return "may mean something else there";
    }
    if (kPlaceLetters.find(word.letter) != std::string_view::npos && !moves_with(word)) {
      return "says nothing that is certain";
    }
    return {};
  }

  [[nodiscard]] bool moves_with(const Word& word) const {
    const std::int32_t motion = meaning_.blocks[block_].motion;
    if (motion < 0) return false;
    const bool of_arc = kArcLetters.find(word.letter) != std::string_view::npos;
    return !of_arc || motion_at(motion).kind == MotionKind::kArc;
  }

  [[nodiscard]] std::string why_not_g(int code, std::span<const Word> words) const {
    if (is_in(kSilentG, code)) return {};
    if (is_work_offset(code)) return why_not_work_offset(code);
    if (code == kToolLengthOn) return why_not_length(words);
    if (code == kToolLengthOff) return {};
    if (code == kBlending) {
      const bool plain = std::ranges::none_of(words, [](const Word& word) {
        return std::string_view("PQRL").find(word.letter) != std::string_view::npos;
      });
      return plain ? "" : "says how far corners may be rounded, which is no word there";
    }
    return "may mean something else there";
  }

  [[nodiscard]] std::string why_not_work_offset(int code) const {
    if (work_offset_ == code) return {};
    if (work_offset_) return "names another work offset";
    return moved_ ? "names a work offset behind the first motion" : "";
  }

  // The control counts the length of a tool from its change on. That is the same as G43 behind it,
  // as long as nothing has moved along Z meanwhile.
  [[nodiscard]] std::string why_not_length(std::span<const Word> words) const {
    const auto h = std::ranges::find(words, 'H', &Word::letter);
    const std::optional<double> tool = tool_behind(words);
    if (!tool) return "names the length of a tool that no M6 has put in";
    if (h != words.end() && h->value != *tool) return "names the length of another tool";
    if (moved_along_tool_ && !has_m(words, 60)) {
      return "comes behind a motion without the length of the tool";
    }
    return {};
  }

  // The tool in the spindle once the block's M6 is done.
  [[nodiscard]] std::optional<double> tool_behind(std::span<const Word> words) const {
    if (!has_m(words, 60)) return tool_;
    const auto t = std::ranges::find(words, 'T', &Word::letter);
    if (t != words.end()) return t->value;
    return fetched_ ? std::optional(fetched_->number) : std::nullopt;
  }

  static bool has_g(std::span<const Word> words, int code) { return has(words, 'G', code); }
  static bool has_m(std::span<const Word> words, int code) { return has(words, 'M', code); }
  static bool has(std::span<const Word> words, char letter, int code) {
    return std::ranges::any_of(words, [&](const Word& word) {
      return word.letter == letter && word.is_number && tenths_of(word) == code;
    });
  }

  // --- acts ---------------------------------------------------------------------------------

  void add_comments(const Block& block) {
    for (const gcode::Comment& comment : program_.comments_of(block)) {
      if (comment.kind == gcode::CommentKind::kActive) {
        refuse(comment.span, "acts on its control");
        continue;
      }
      Act& act = add(ActKind::kComment, comment.span);
      act.text = without_brackets(program_.source.text(comment.span));
    }
  }

  void add_acts(std::span<const Word> words, const BlockMeaning& meaning) {
    const bool moves = meaning.motion >= 0;
    for (const Word& word : words) {
      if (word.letter == 'T') fetched_ = {word.value, word.span};
    }
    for (const Word& word : words) {
      if (word.letter == 'M' && tenths_of(word) == 60) add_tool(word);
    }
    for (const Word& word : words) {
      if (word.letter == 'S') add_speed(word, meaning);
    }
    for (const int code : {30, 40, 80, 50, 90}) {
      if (const Word* word = m_word(words, code)) add_function(*word, moves);
    }
    for (const Word& word : words) {
      if (word.letter == 'G') add_g(word);
    }
    if (moves) add_motion(meaning);
    for (const int code : {0, 10}) {
      if (const Word* word = m_word(words, code)) add_stop(*word, moves);
    }
    for (const int code : {20, 300}) {
      if (const Word* word = m_word(words, code)) add_end(*word);
    }
  }

  static const Word* m_word(std::span<const Word> words, int code) {
    const auto found = std::ranges::find_if(
        words, [code](const Word& word) { return word.letter == 'M' && tenths_of(word) == code; });
    return found == words.end() ? nullptr : &*found;
  }

  Act& add(ActKind kind, gcode::SourceSpan where, double number = 0) {
    Act act;
    act.kind = kind;
    act.block = block_;
    act.where = where;
    act.number = number;
    result_.acts.push_back(act);
    return result_.acts.back();
  }

  void add_tool(const Word& word) {
    if (!fetched_) return refuse(word.span, "names no tool");
    tool_ = fetched_->number;
    fetched_.reset();
    without_length_.reset();
    moved_along_tool_ = false;
    spindle_.reset();
    speed_.reset();
    (void)add(ActKind::kTool, word.span, *tool_);
  }

  void add_speed(const Word& word, const BlockMeaning& meaning) {
    if (speed_ == word.value) return;
    if (word.value < 0) return refuse(word.span, "is no speed there");
    const bool cuts = meaning.motion >= 0 && motion_at(meaning.motion).kind != MotionKind::kRapid;
    if (cuts) return refuse(word.span, "changes the speed in a cutting move");
    speed_ = word.value;
    (void)add(ActKind::kSpeed, word.span, word.value);
  }

  void add_function(const Word& word, bool moves) {
    const auto code = static_cast<int>(word.value);
    const bool ends = code == 5 || code == 9;
    if (ends && moves) {
      return refuse(word.span, "acts before or behind the motion of its block: controls differ");
    }
    (code == 8 || code == 9 ? coolant_ : spindle_) = !ends;
    (void)add(ActKind::kFunction, word.span, code);
  }

  void add_stop(const Word& word, bool moves) {
    if (moves) return refuse(word.span, "acts before or behind the motion of its block");
    if (spindle_ != false || coolant_ == true) {
      return refuse(word.span, "stops spindle and coolant on some controls, and they may be on");
    }
    (void)add(ActKind::kFunction, word.span, word.value);
  }

  void add_end(const Word& word) {
    ended_ = true;
    (void)add(ActKind::kEnd, word.span, word.value);
  }

  void add_g(const Word& word) {
    const int code = tenths_of(word);
    if (code == kToolLengthOff) without_length_ = word.span;
    if (code == kToolLengthOn) without_length_.reset();
    if (!is_work_offset(code) || work_offset_ == code) return;
    work_offset_ = code;
    (void)add(ActKind::kWorkOffset, word.span, word.value);
  }

  void add_motion(const BlockMeaning& meaning) {
    const gcode::SourceSpan here = program_.blocks[block_].span;
    const Motion& motion = motion_at(meaning.motion);
    const gcode::ModalState& state = meaning_.states[meaning.state_after];
    if (fetched_) {
      refuse(fetched_->where, "changes the tool on some controls, and on others only fetches it");
      return fetched_.reset();
    }
    if (without_length_) {
      (void)add(ActKind::kNoLength, *without_length_);
      without_length_.reset();
    }
    if (state.distance == gcode::DistanceMode::kIncremental) return refuse(here, "is an increment");
    if (!path_alone_counts(state)) {
      return refuse(here, "moves in a state in which its words are not the path");
    }
    if (!motion.end_known || (motion.kind == MotionKind::kArc && !motion.start_known)) {
      return refuse(here, "moves from a place that is not known");
    }
    Act act;
    act.kind = ActKind::kMotion;
    act.block = block_;
    act.where = here;
    act.motion = meaning.motion;
    if (motion.kind != MotionKind::kRapid) {
      if (!state.feed) return refuse(here, "moves at a feed that is not known");
      act.feed = state.feed;
    }
    moved_ = true;
    moved_along_tool_ |= motion.axes_named[2];
    result_.acts.push_back(act);
  }

  [[nodiscard]] const Motion& motion_at(std::int32_t index) const {
    return meaning_.motions[static_cast<std::size_t>(index)];
  }

  struct Fetched {
    double number = 0;
    gcode::SourceSpan where;
  };

  const gcode::Program& program_;
  const gcode::Interpretation& meaning_;
  ProgramActs result_;
  std::uint32_t block_ = 0;
  bool told_ = false;  // the block has its obstacle
  bool ended_ = false;
  bool moved_ = false;
  bool moved_along_tool_ = false;                    // along Z, since the tool was put in
  std::optional<Fetched> fetched_;                   // T without its M6 yet
  std::optional<double> tool_;                       // in the spindle
  std::optional<double> speed_;                      // since the tool was put in
  std::optional<int> work_offset_;                   // in tenths
  std::optional<gcode::SourceSpan> without_length_;  // G49, and nothing moved since
  Known spindle_;
  Known coolant_;
};

}  // namespace

ProgramActs acts_of(const gcode::Program& program, const gcode::Interpretation& meaning) {
  return ActReader(program, meaning).read();
}

}  // namespace batten::postproc
