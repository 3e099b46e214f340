#include "postproc/proof/common_events.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "gcode/klartext/statement.h"
#include "gcode/siemens/block.h"
#include "gcode/state/block_words.h"
#include "gcode/state/dwell.h"
#include "gcode/state/modal_state.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::postproc {
namespace {

using gcode::Block;
using gcode::BlockMeaning;
using gcode::Motion;
using gcode::MotionKind;
using gcode::Word;

// In tenths. Their effect is in the motions and in the states that are compared.
constexpr std::array kSilent = {0,   10,  20,  30,  170, 180, 190, 200, 210, 400, 700,
                                710, 800, 900, 901, 910, 911, 940, 970, 980, 990};
constexpr int kLengthOn = 430;
constexpr int kLengthOff = 490;
constexpr int kBlending = 640;
constexpr int kDwell = 40;

int tenths(double value) { return static_cast<int>(std::lround(value * 10)); }

// What a Siemens block may name beside its words; D is a word, too. What the others end is an event
// of its own text where it begins.
constexpr std::array<std::string_view, 7> kReadNames = {"G71",    "G700",    "G710",  "D",
                                                        "COMPOF", "TRAFOOF", "DIAMOF"};

// Texts of Klartext programs, and of what was made of them, that stand for events.

// `TOOL CALL 5 Z S3000`, with what a program of plain words can say.
struct ToolCall {
  std::optional<double> tool;
  std::optional<double> speed;
};

// What a Klartext program says where its source moves behind G49, or along Z behind a tool change
// without G43.
constexpr std::string_view kCountsAlways = "; G49: the length of the tool counts";
constexpr std::string_view kCountsUnsaid = "; no G43: the length of the tool counts";

std::optional<double> number_of(std::string_view token) {
  const auto number = gcode::read_number(token);
  return number ? std::optional(number->value) : std::nullopt;
}

// Takes CYCL DEF and the number of the part off the front; false where they do not stand there.
bool takes_cycle_part(gcode::KlartextTokens& tokens, std::string_view part) {
  return gcode::is_same_word(tokens.next(), "CYCL") && gcode::is_same_word(tokens.next(), "DEF") &&
         tokens.next() == part;
}

bool has_digit(std::string_view text) {
  return text.find_first_of("0123456789") != std::string_view::npos;
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
      continue;  // the feed is not known behind it
    } else if (!along_z && !call.tool) {
      call.tool = number_of(token);
      if (!call.tool) return std::nullopt;
    } else {
      return std::nullopt;
    }
  }
  return along_z ? std::optional(call) : std::nullopt;
}

// `CYCL DEF 9.0 DWELL TIME`, in any dialog language: the next block says how long.
bool is_dwell_begin(std::string_view content) {
  gcode::KlartextTokens tokens(content);
  return takes_cycle_part(tokens, "9.0");
}

// Milliseconds of `CYCL DEF 9.1 DWELL 1.5`; nothing where it is no time of whole milliseconds up to
// an hour.
std::optional<std::int32_t> dwell_time_in(std::string_view content) {
  gcode::KlartextTokens tokens(content);
  if (!takes_cycle_part(tokens, "9.1") || has_digit(tokens.next())) return std::nullopt;
  const auto seconds = number_of(tokens.next());
  if (!seconds || !tokens.next().empty()) return std::nullopt;
  const double ms = *seconds * 1000;
  constexpr double kHour = 3'600'000;
  constexpr double kRounding = 1e-6;
  if (!(ms > 0.5 && ms <= kHour) || std::abs(ms - std::round(ms)) > kRounding) return std::nullopt;
  return static_cast<std::int32_t>(std::lround(ms));
}

// In tenths: G54 to G59.
bool is_work_offset(int code) { return code >= 540 && code <= 590 && code % 10 == 0; }

// 54 of "; G54: its datum is active".
std::optional<int> datum_in_remark(std::string_view comment) {
  constexpr std::string_view kBegin = "; G";
  if (!comment.starts_with(kBegin)) return std::nullopt;
  int code = 0;
  const char* end = comment.data() + comment.size();
  const auto read = std::from_chars(comment.data() + kBegin.size(), end, code);
  const std::string_view rest(read.ptr, static_cast<std::size_t>(end - read.ptr));
  const bool offset = read.ec == std::errc{} && is_work_offset(code * 10);
  return offset && rest == ": its datum is active" ? std::optional(code) : std::nullopt;
}

// Without (), ; and the blanks at both ends; capitals alone.
std::string capitals_of_comment(std::string_view comment) {
  constexpr std::string_view kAround = "(); \t";
  const std::size_t begin = comment.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return {};
  const std::size_t end = comment.find_last_not_of(kAround) + 1;
  std::string text;
  for (const char c : comment.substr(begin, end - begin)) text.push_back(gcode::upper(c));
  return text;
}

// Of a statement, or of the comment that it became; in capitals.
bool is_blank_form(std::string_view capitals) { return capitals.starts_with("BLK FORM "); }

class CommonLister {
 public:
  explicit CommonLister(const ReadProgram& read)
      : program_(*read.program), interpretation_(*read.interpretation) {}

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
      if (meaning.motion >= 0) add_cut(meaning);
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
    if (has(program_.words_of(block), 'G', kDwell)) return list_dwell(block);
    list_words(program_.words_of(block), meaning);
  }

  // A Siemens block with units or D, whose motion the interpreter would not follow: it has none.
  [[nodiscard]] bool names_are_read(const Block& block) const {
    if (block.opacity != gcode::ParseStatus::kNamedWords) return false;
    const gcode::BlockWords words(program_.words_of(block));
    const bool plain = words.problem() == gcode::BlockWords::Problem::kNone && words.all_numbers();
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
    if (const auto datum = datum_in_remark(text)) list_work_offset(*datum * 10);
    const bool counts_not = text == kCountsAlways;
    if (!counts_not && text != kCountsUnsaid) return;
    add_word(counts_not ? "G49" : "length not said");
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
    if (capitals == "PLANE RESET STAY") return true;
    if (list_dwell_cycle(content)) return true;
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

  void list_words(std::span<const Word> words, const BlockMeaning& meaning) {
    const bool moves = meaning.motion >= 0;
    if (const Word* t = word_of(words, 'T')) fetched_ = t->value;
    if (has(words, 'M', 60)) list_tool(std::exchange(fetched_, std::nullopt));
    if (const Word* s = word_of(words, 'S')) list_speed(s->value);
    list_starts(words);
    // In Klartext M5 and M9 come behind the motion of their block.
    if (!moves || !is_klartext()) list_stops(words, moves);
    for (const Word& word : words) list_word(word, words);
    if (moves) list_motion(words, meaning);
    if (moves && is_klartext()) list_stops(words, false);
    for (const int code : {0, 10, 20}) {
      if (has(words, 'M', code)) add_function(code);
    }
    // Klartext ends by END PGM alone, too; others say M30 for that, behind a comment.
    if (has(words, 'M', 300) && (moves || !end_is_mark_)) add_function(300);
    if (std::ranges::any_of(words, [](const Word& word) { return word.letter != 'N'; })) {
      end_is_mark_ = false;
    }
  }

  void list_dwell(const Block& block) {
    const auto ms = gcode::dwell_ms(program_.words_of(block), program_.dwells);
    ms ? add_dwell(*ms) : add_own_text(block);
  }

  // In Klartext M13 and M14 are M3 and M4 with M8.
  void list_starts(std::span<const Word> words) {
    const bool both = is_klartext() && (has(words, 'M', 130) || has(words, 'M', 140));
    for (const int code : {30, 40}) {
      const bool with_coolant = is_klartext() && has(words, 'M', code + 100);
      if (has(words, 'M', code) || with_coolant) add_function(code);
    }
    if (has(words, 'M', 80) || both) add_function(80);
  }

  void list_stops(std::span<const Word> words, bool beside_motion) {
    for (const int code : {50, 90}) {
      if (!has(words, 'M', code)) continue;
      // Controls differ in what comes first.
      beside_motion
          ? add_text(fmt::format("M{} in {}", code / 10, gcode::describe(program_.language)))
          : add_function(code);
    }
  }

  static const Word* word_of(std::span<const Word> words, char letter) {
    const auto found = std::ranges::find(words, letter, &Word::letter);
    return found == words.end() ? nullptr : &*found;
  }
  static bool has(std::span<const Word> words, char letter, int code) {
    return std::ranges::any_of(words, [&](const Word& word) {
      return word.letter == letter && tenths(word.value) == code;
    });
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

  // Those of list_words, and motion words and places, are left out.
  void list_word(const Word& word, std::span<const Word> words) {
    switch (word.letter) {
      case 'G':
        return list_g(tenths(word.value), word, words);
      case 'M':
        return list_other_function(word);
      case 'D':
        return list_edge(word);
      case 'H':
        if (!has(words, 'G', kLengthOn)) add_own_text(word);
        return;
      default:
        // Tools, speeds, feeds and places are listed with what they belong to.
        if (std::string_view("NTSFXYZIJKR").find(word.letter) == std::string_view::npos) {
          add_own_text(word);
        }
        return;
    }
  }

  void list_other_function(const Word& word) {
    constexpr std::array kListed = {0, 10, 20, 30, 40, 50, 60, 80, 90, 300};
    constexpr std::array kListedInKlartext = {130, 140};
    const int code = tenths(word.value);
    const bool listed =
        std::ranges::find(kListed, code) != kListed.end() ||
        (is_klartext() && std::ranges::find(kListedInKlartext, code) != kListedInKlartext.end());
    if (!listed) add_own_text(word);
  }

  // D1, the first edge of a Siemens tool, is its length; D0 is none.
  void list_edge(const Word& word) {
    const bool siemens = program_.language == gcode::Language::kSiemens && word.is_number;
    if (siemens && word.value == 0) {
      length_is_off_ = true;
      length_is_said_ = true;
    } else if (siemens && word.value == 1 && tool_ && !moved_along_tool_) {
      length_is_off_ = false;
      length_is_said_ = true;
    } else {
      add_own_text(word);
    }
  }

  void list_g(int code, const Word& word, std::span<const Word> words) {
    if (std::ranges::find(kSilent, code) != kSilent.end()) return;
    if (is_work_offset(code)) return list_work_offset(code);
    if (code == kLengthOff) {
      length_is_off_ = true;
      length_is_said_ = true;
      return;
    }
    const Word* h = word_of(words, 'H');
    const bool of_the_tool = tool_ && !moved_along_tool_ && (h == nullptr || h->value == *tool_);
    if (code == kLengthOn && of_the_tool) {
      length_is_off_ = false;
      length_is_said_ = true;
      return;
    }
    if (code == kBlending) return;  // a tolerance beside it is an event
    add_own_text(word);
  }

  void list_work_offset(int code) {
    if (std::exchange(work_offset_, code) != code) add_word(fmt::format("G{}", code / 10));
  }

  // --- motions ------------------------------------------------------------------------------

  void list_motion(std::span<const Word> words, const BlockMeaning& meaning) {
    if (fetched_) add_text(fmt::format("T{}", *std::exchange(fetched_, std::nullopt)));
    if (std::exchange(length_is_off_, false)) add_word("G49");
    const Motion& motion = interpretation_.motions[static_cast<std::size_t>(meaning.motion)];
    if (tool_ && !length_is_said_ && motion.axes_named[2]) {
      length_is_said_ = true;
      add_word("length not said");
    }
    moved_along_tool_ |= motion.axes_named[2];
    if (!path_alone_counts(state_after()) || !motion.end_known) {
      for (const Word& word : words) add_own_text(word);
      return;
    }
    if (!motion.start_known) {
      ProgramEvent& event = add_event(EventKind::kText);
      event.text = described(motion);
      event.motion = meaning.motion;
      return;
    }
    if (motion.kind == MotionKind::kRapid) {
      ProgramEvent& event = add_event(EventKind::kRapid);
      event.motion = meaning.motion;
    } else if (has_length(motion.piece)) {
      add_cut(meaning);
    }
  }

  // The axes that it names; where they go is compared as places of rapids are.
  [[nodiscard]] std::string described(const Motion& motion) const {
    std::string text = motion.kind == MotionKind::kRapid  ? "rapid of"
                       : motion.kind == MotionKind::kLine ? "line of"
                                                          : "arc from a position that is not known";
    for (int axis = 0; axis < 3; ++axis) {
      if (motion.axes_named[static_cast<std::size_t>(axis)])
        text += fmt::format(" {}", "XYZ"[axis]);
    }
    const std::optional<double>& feed = state_after().feed;
    if (motion.kind != MotionKind::kRapid) text += feed ? fmt::format(" F{:.6g}", *feed) : " F?";
    return text;
  }

  static bool has_length(const gcode::MotionPath& path) {
    return !path.is_line() || path.start() != path.end();
  }

  void add_cut(const BlockMeaning& meaning) {
    list_.cuts.push_back({static_cast<std::uint32_t>(meaning.motion), state_after().feed});
  }

  // --- events -------------------------------------------------------------------------------

  void add_function(int code) { add_word(fmt::format("M{}", code / 10)); }
  void add_dwell(std::int32_t ms) { add_word(fmt::format("dwell of {} ms", ms)); }
  void add_word(std::string text) { add_event(EventKind::kWord).text = std::move(text); }
  void add_text(std::string text) { add_event(EventKind::kText).text = std::move(text); }
  void add_own_text(const Block& block) { add_text(std::string(program_.source.text(block.span))); }
  void add_own_text(const Word& word) { add_text(std::string(program_.source.text(word.span))); }

  ProgramEvent& add_event(EventKind kind) {
    ProgramEvent event;
    event.kind = kind;
    event.block = block_index_;
    event.state_before =
        block_index_ > 0 ? interpretation_.blocks[block_index_ - 1].state_after : 0;
    list_.cuts_before.push_back(list_.cuts.size());
    list_.events.push_back(std::move(event));
    return list_.events.back();
  }

  [[nodiscard]] const gcode::ModalState& state_after() const {
    return interpretation_.states[interpretation_.blocks[block_index_].state_after];
  }

  const gcode::Program& program_;
  const gcode::Interpretation& interpretation_;
  ProgramEvents list_;
  std::uint32_t block_index_ = 0;
  std::optional<double> fetched_;  // T without its M6 yet
  std::optional<double> tool_;
  std::optional<double> speed_;
  int work_offset_ = 0;  // in tenths
  bool length_is_off_ = false;
  bool length_is_said_ = false;  // whether the length of the tool in the spindle counts
  bool moved_along_tool_ = false;
  bool end_is_mark_ = false;  // the last comment stands for an END PGM
};

}  // namespace

ProgramEvents list_common_events(const ReadProgram& read) { return CommonLister(read).run(); }

}  // namespace batten::postproc
