#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "gcode/klartext/statement.h"
#include "gcode/siemens/block.h"
#include "gcode/state/block_words.h"
#include "gcode/state/dwell.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"
#include "postproc/proof/program_events.h"

namespace batten::postproc {
namespace {

using gcode::Block;
using gcode::BlockMeaning;
using gcode::BlockWords;
using gcode::Code;
using gcode::Motion;
using gcode::MotionKind;
using gcode::Word;

// In tenths.
constexpr Code kDwell = 40;
constexpr Code kLengthOn = 430;
constexpr Code kLengthOff = 490;
constexpr Code kBlending = 640;
constexpr Code kEnd = 300;

// What a Siemens block may name beside its words; D is a word, too. What the others end is an event
// of its own text where it begins.
constexpr std::array<std::string_view, 7> kReadNames = {"G71",    "G700",    "G710",  "D",
                                                        "COMPOF", "TRAFOOF", "DIAMOF"};

// Texts of Klartext programs, and of what was made of them, that are events.

// `TOOL CALL 5 Z S3000`, with what a program of plain words can say.
struct ToolCall {
  std::optional<double> tool;
  std::optional<double> speed;
};

// What a Klartext program says where its source moves after G49, or along Z after a tool change
// without G43.
constexpr std::string_view kCountsAlways = "; G49: the length of the tool counts";
constexpr std::string_view kCountsUnsaid = "; no G43: the length of the tool counts";

std::optional<double> number_of(std::string_view token) {
  const auto number = gcode::read_number(token);
  return number ? std::optional(number->value) : std::nullopt;
}

// Nothing where there is more.
std::optional<ToolCall> tool_call_in(std::string_view content) {
  gcode::KlartextTokens tokens(content);
  (void)tokens.next();  // TOOL
  (void)tokens.next();  // CALL
  ToolCall call;
  bool along_z = false;
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
    if (token == "Z") {
      along_z = true;
    } else if (token.starts_with('S')) {
      call.speed = number_of(token.substr(1));
      if (!call.speed) return std::nullopt;
    } else if (token.starts_with('F') && number_of(token.substr(1))) {
      continue;  // the feed is not known after it
    } else if (!along_z && !call.tool) {
      call.tool = number_of(token);
      if (!call.tool) return std::nullopt;
    } else {
      return std::nullopt;
    }
  }
  return along_z ? std::optional(call) : std::nullopt;
}

// The tokens after CYCL DEF and the number of this part; nothing where that is something else.
std::optional<gcode::KlartextTokens> after_cycle_part(std::string_view content,
                                                      std::string_view part) {
  gcode::KlartextTokens tokens(content);
  const bool is_cycle =
      gcode::is_same_word(tokens.next(), "CYCL") && gcode::is_same_word(tokens.next(), "DEF");
  return is_cycle && tokens.next() == part ? std::optional(tokens) : std::nullopt;
}

// `CYCL DEF 9.0 DWELL TIME`, in any dialog language: the next block says how long.
bool is_dwell_begin(std::string_view content) {
  return after_cycle_part(content, "9.0").has_value();
}

// Milliseconds of `CYCL DEF 9.1 DWELL 1.5`; nothing where it is no time of whole milliseconds up to
// an hour.
std::optional<std::int32_t> dwell_time_in(std::string_view content) {
  auto tokens = after_cycle_part(content, "9.1");
  if (!tokens || std::ranges::any_of(tokens->next(), gcode::is_digit)) return std::nullopt;
  const auto seconds = number_of(tokens->next());
  if (!seconds || !tokens->next().empty()) return std::nullopt;
  const double ms = *seconds * 1000;
  constexpr double kRounding = 1e-6;
  if (!(ms > 0.5 && ms <= gcode::kLongestDwellMs)) return std::nullopt;
  if (std::abs(ms - std::round(ms)) > kRounding) return std::nullopt;
  return static_cast<std::int32_t>(std::lround(ms));
}

constexpr std::array<Code, 6> kWorkOffsets = {540, 550, 560, 570, 580, 590};  // G54 to G59

// Of "; G54: its datum is active".
std::optional<Code> datum_in_remark(std::string_view comment) {
  const auto said = std::ranges::find_if(kWorkOffsets, [comment](Code code) {
    return comment == fmt::format("; G{}: its datum is active", code / 10);
  });
  return said != kWorkOffsets.end() ? std::optional(*said) : std::nullopt;
}

// Without (), ; and the blanks at both ends; capitals alone.
std::string capitals_of_comment(std::string_view comment) {
  constexpr std::string_view kAround = "(); \t";
  const std::size_t begin = comment.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return {};
  return gcode::in_capitals(comment.substr(begin, comment.find_last_not_of(kAround) + 1 - begin));
}

// Of a statement, or of the comment that it became; in capitals.
bool is_blank_form(std::string_view capitals) { return capitals.starts_with("BLK FORM "); }

class CommonLister : EventLister {
 public:
  explicit CommonLister(const ReadProgram& read) : EventLister(read) {}

  ProgramEvents run() {
    for (block_index_ = 0; block_index_ < program_.blocks.size(); ++block_index_) {
      list_block(program_.blocks[block_index_], interpretation_.blocks[block_index_]);
    }
    list_.cuts_before.push_back(list_.cuts.size());
    return std::move(list_);
  }

 private:
  [[nodiscard]] bool is_klartext() const { return program_.language == gcode::Language::kKlartext; }

  void list_block(const Block& block, const BlockMeaning& meaning) {
    if (meaning.of_curve) {
      for (const Motion& motion : gcode::motions_of(interpretation_, block_index_)) {
        add_cut(motion, false);
      }
      return;
    }
    list_comments(block);
    if (block.opacity == gcode::ParseStatus::kProgramMark) return;
    const bool foreign = is_klartext() && block.opacity == gcode::ParseStatus::kForeign;
    if (foreign && !block.block_delete && list_statement(block)) return;
    const bool split =
        block.opacity == gcode::ParseStatus::kNone && meaning.kind != gcode::BlockKind::kOpaque;
    const bool plain = (split || names_are_read(block)) && !block.block_delete &&
                       !meaning.label_referenced && !meaning.entered_from_elsewhere;
    if (!plain) return add_own_text(block);
    const BlockWords words(program_.words_of(block));
    if (!words.has_g(kDwell)) return list_words(block, words, meaning);
    const auto ms = gcode::dwell_ms(program_.words_of(block), program_.dwells);
    ms ? add_dwell(*ms) : add_own_text(block);
  }

  // A Siemens block with units or D, whose motion the interpreter would not follow: it has none.
  [[nodiscard]] bool names_are_read(const Block& block) const {
    if (block.opacity != gcode::ParseStatus::kNamedWords) return false;
    const BlockWords words(program_.words_of(block));
    const bool plain = words.problem() == BlockWords::Problem::kNone && words.all_numbers();
    if (!plain || words.has_any("XYZIJKRABCUVW")) return false;
    const auto names = gcode::siemens_names_in(program_.source.text(), block.span);
    return std::ranges::all_of(names, [](const gcode::SiemensName& each) {
      return std::ranges::find(kReadNames, each.name) != kReadNames.end();
    });
  }

  void list_comments(const Block& block) {
    for (const gcode::Comment& comment : program_.comments_of(block)) {
      const std::string_view text = program_.source.text(comment.span);
      if (comment.kind == gcode::CommentKind::kActive) add_text(std::string(text));
      const std::string capitals = capitals_of_comment(text);
      if (is_blank_form(capitals)) add_word(capitals);
      end_is_mark_ = capitals == "END PGM";
      if (is_klartext()) list_remark(text);
    }
  }

  void list_remark(std::string_view text) {
    if (const auto datum = datum_in_remark(text)) list_work_offset(*datum);
    if (text == kCountsAlways) add_word("G49");
    if (text == kCountsUnsaid) add_word("length not said");
  }

  // TOOL CALL, BLK FORM, PLANE RESET STAY.
  bool list_statement(const Block& block) {
    const gcode::KlartextParts parts = gcode::klartext_parts(program_.source.text(), block.span);
    const std::string_view content = program_.source.text(parts.content);
    if (parts.continues) return false;
    const std::string capitals = capitals_of_comment(content);
    if (is_blank_form(capitals)) {
      add_word(capitals);
      return true;
    }
    if (capitals == "PLANE RESET STAY" || list_dwell_cycle(content)) return true;
    if (gcode::klartext_kind(content) != gcode::KlartextKind::kToolCall) return false;
    const auto call = tool_call_in(content);
    if (!call) return false;
    if (call->tool) list_tool(*call->tool);
    if (call->speed) list_speed(*call->speed);
    return true;
  }

  // Two blocks, the first of which says only that the second is a time.
  bool list_dwell_cycle(std::string_view content) {
    if (is_dwell_begin(content)) {
      return block_index_ + 1 < program_.blocks.size() &&
             dwell_time_in(content_at(block_index_ + 1)).has_value();
    }
    const auto ms = dwell_time_in(content);
    if (!ms || block_index_ == 0 || !is_dwell_begin(content_at(block_index_ - 1))) return false;
    add_dwell(*ms);
    return true;
  }

  [[nodiscard]] std::string_view content_at(std::uint32_t block) const {
    const Block& at = program_.blocks[block];
    const gcode::KlartextParts parts = gcode::klartext_parts(program_.source.text(), at.span);
    return parts.continues || at.block_delete ? "" : program_.source.text(parts.content);
  }

  // --- words --------------------------------------------------------------------------------

  void list_words(const Block& block, const BlockWords& words, const BlockMeaning& meaning) {
    const bool moves = meaning.motion >= 0;
    if (const Word* t = words.find('T')) fetched_ = t->value;
    if (words.has_m(60)) list_tool(std::exchange(fetched_, std::nullopt));
    if (const Word* s = words.find('S')) list_speed(s->value);
    list_starts(words);
    // In Klartext M5 and M9 come after the motion of their block.
    if (!moves || !is_klartext()) list_stops(words, moves);
    for (const Word& word : program_.words_of(block)) list_word(word, words);
    if (moves) list_motion(block, meaning);
    if (moves && is_klartext()) list_stops(words, false);
    for (const Code code : {0, 10, 20}) {
      if (words.has_m(code)) add_function(code);
    }
    // Klartext ends by END PGM alone, too; others say M30 for that, after a comment.
    if (words.has_m(kEnd) && (moves || !end_is_mark_)) add_function(kEnd);
    if (words.has_words()) end_is_mark_ = false;
  }

  // In Klartext M13 and M14 are M3 and M4 with M8.
  void list_starts(const BlockWords& words) {
    bool coolant = words.has_m(80);
    for (const Code code : {30, 40}) {
      const bool with_coolant = is_klartext() && words.has_m(code + 100);
      if (words.has_m(code) || with_coolant) add_function(code);
      coolant |= with_coolant;
    }
    if (coolant) add_function(80);
  }

  void list_stops(const BlockWords& words, bool beside_motion) {
    for (const Code code : {50, 90}) {
      if (!words.has_m(code)) continue;
      // Controls differ in what comes first.
      beside_motion
          ? add_text(fmt::format("M{} in {}", code / 10, gcode::describe(program_.language)))
          : add_function(code);
    }
  }

  void list_tool(std::optional<double> tool) {
    add_word(tool ? fmt::format("tool {}", *tool) : "tool ?");
    tool_ = tool;
    fetched_.reset();
    speed_.reset();
    length_is_off_ = false;
    length_is_said_ = is_klartext();
    moved_along_tool_ = false;
  }

  void list_speed(double speed) {
    if (speed_ == speed) return;
    speed_ = speed;
    add_word(fmt::format("speed {}", speed));
  }

  // What list_words does not list: tools, speeds, feeds and positions belong to others.
  void list_word(const Word& word, const BlockWords& words) {
    if (word.letter == 'G') return list_g(word, words);
    if (word.letter == 'D') return list_edge(word);
    constexpr std::array<Code, 10> kListed = {0, 10, 20, 30, 40, 50, 60, 80, 90, kEnd};
    const Code code = gcode::code_of(word);
    const bool listed = word.letter == 'M' ? std::ranges::find(kListed, code) != kListed.end() ||
                                                 (is_klartext() && (code == 130 || code == 140))
                        : word.letter == 'H' ? words.has_g(kLengthOn)
                                             : std::string_view("NTSFXYZIJKR").find(word.letter) !=
                                                   std::string_view::npos;
    if (!listed) add_own_text(word);
  }

  void say_length(bool counts) {
    length_is_off_ = !counts;
    length_is_said_ = true;
  }
  [[nodiscard]] bool is_at_tool_change() const { return tool_ && !moved_along_tool_; }

  // D1, the first edge of a Siemens tool, is its length; D0 is none.
  void list_edge(const Word& word) {
    const bool siemens = program_.language == gcode::Language::kSiemens && word.is_number;
    const bool off = siemens && word.value == 0;
    if (!off && !(siemens && word.value == 1 && is_at_tool_change())) return add_own_text(word);
    say_length(!off);
  }

  void list_g(const Word& word, const BlockWords& words) {
    const Code code = gcode::code_of(word);
    // Their effect is in the motions and in the states that are compared. A tolerance beside G64 is
    // an event.
    if (gcode::row_of_g(code).is(gcode::trait::kSilent) || code == kBlending) return;
    if (std::ranges::find(kWorkOffsets, code) != kWorkOffsets.end()) return list_work_offset(code);
    const Word* h = words.find('H');
    const bool of_the_tool = is_at_tool_change() && (h == nullptr || h->value == *tool_);
    if (code != kLengthOff && !(code == kLengthOn && of_the_tool)) return add_own_text(word);
    say_length(code == kLengthOn);
  }

  void list_work_offset(Code code) {
    if (std::exchange(work_offset_, code) != code) add_word(fmt::format("G{}", code / 10));
  }

  // --- motions ------------------------------------------------------------------------------

  void list_motion(const Block& block, const BlockMeaning& meaning) {
    if (fetched_) add_text(fmt::format("T{}", *std::exchange(fetched_, std::nullopt)));
    if (std::exchange(length_is_off_, false)) add_word("G49");
    const Motion& motion = motion_of(meaning);
    if (tool_ && !length_is_said_ && motion.axes_named[2]) {
      length_is_said_ = true;
      add_word("length not said");
    }
    moved_along_tool_ |= motion.axes_named[2];
    if (!path_alone_counts(state_after()) || !motion.end_known) {
      for (const Word& word : program_.words_of(block)) add_own_text(word);
    } else if (!motion.start_known) {
      add_text(described(motion));
      list_.events.back().motion = meaning.motion;
    } else {
      add_motion(meaning, false);
    }
  }

  // The axes that it names; where they go is compared as the ends of rapids are.
  [[nodiscard]] std::string described(const Motion& motion) const {
    std::string text = motion.kind == MotionKind::kRapid  ? "rapid of"
                       : motion.kind == MotionKind::kLine ? "line of"
                                                          : "arc from a position that is not known";
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (motion.axes_named[axis]) text += fmt::format(" {}", "XYZ"[axis]);
    }
    const std::optional<double>& feed = state_after().feed;
    if (motion.kind != MotionKind::kRapid) text += feed ? fmt::format(" F{:.6g}", *feed) : " F?";
    return text;
  }

  // --- events -------------------------------------------------------------------------------

  void add_function(Code code) { add_word(fmt::format("M{}", code / 10)); }
  void add_dwell(std::int32_t ms) { add_word(fmt::format("dwell of {} ms", ms)); }
  void add_own_text(const Block& block) { add_text(std::string(program_.source.text(block.span))); }
  void add_own_text(const Word& word) { add_text(std::string(program_.source.text(word.span))); }

  std::optional<double> fetched_;  // T without its M6 yet
  std::optional<double> tool_;
  std::optional<double> speed_;
  Code work_offset_ = 0;
  bool length_is_off_ = false;
  bool length_is_said_ = false;  // whether the length of the tool in the spindle counts
  bool moved_along_tool_ = false;
  bool end_is_mark_ = false;  // the last comment stands for an END PGM
};

}  // namespace

ProgramEvents list_common_events(const ReadProgram& read) { return CommonLister(read).run(); }

}  // namespace batten::postproc
