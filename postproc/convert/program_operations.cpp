#include "postproc/convert/program_operations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "gcode/klartext/statement.h"
#include "gcode/siemens/block.h"
#include "gcode/state/block_words.h"
#include "gcode/state/dwell.h"
#include "gcode/text/characters.h"
#include "gcode/text/number_format.h"

namespace batten::postproc {
namespace {

using gcode::Block;
using gcode::BlockMeaning;
using gcode::Language;
using gcode::Motion;
using gcode::MotionKind;
using gcode::Word;

constexpr std::string_view kOfNoTool = "names the length of a tool that no M6 has put in";

// --- words that mean the same on every control of their language --------------------------------

// G54 to G59.
bool names_work_offset(int code) {
  const gcode::CodeRow& row = gcode::row_of_g(code);
  return row.group == gcode::CodeGroup::kWorkOffset && row.is(gcode::trait::kCommon);
}

// M0 to M6, M8, M9, M30; in Klartext M13 and M14, each M3 or M4 with M8, too.
bool is_certain_function(int code, Language language) {
  return gcode::row_of_m(code).is(gcode::trait::kCommon) ||
         (language == Language::kKlartext && (code == 130 || code == 140));
}

// Whether words of this letter can be certain at all.
bool is_certain_letter(char letter, Language language) {
  return std::string_view("NGMXYZIJKRFSTH").find(letter) != std::string_view::npos ||
         (language == Language::kSiemens && letter == 'D');
}

bool is_arc_letter(char letter) {
  return std::string_view("IJKR").find(letter) != std::string_view::npos;
}

bool is_place_letter(char letter) {
  return is_arc_letter(letter) || (letter >= 'X' && letter <= 'Z');
}

// Why the block as a whole cannot be said; empty where its words are to be looked at. A Siemens
// block of named words counts as plain here.
std::string_view why_no_plain_block(const gcode::Block& block, const gcode::BlockMeaning& meaning) {
  if (block.block_delete) return "is left out by some controls, run by others";
  if (block.has_checksum) return "has a check sum";
  const bool named = block.opacity == gcode::ParseStatus::kNamedWords;
  if (block.opacity != gcode::ParseStatus::kNone && !named) return "is no block of plain words";
  if (meaning.label_referenced || meaning.entered_from_elsewhere) return "is jumped to";
  if (meaning.kind == gcode::BlockKind::kOpaque && !named) return "is not understood";
  return {};
}

// The text of a comment without its brackets, or what it begins with.
std::string_view text_of_comment(std::string_view comment) {
  if (comment.starts_with('(')) {
    comment.remove_prefix(1);
    if (comment.ends_with(')')) comment.remove_suffix(1);
  } else if (comment.starts_with(';') || comment.starts_with('*')) {
    comment.remove_prefix(1);
  }
  while (comment.starts_with(' ')) comment.remove_prefix(1);
  while (comment.ends_with(' ')) comment.remove_suffix(1);
  return comment;
}

// --- statements of Klartext that are no words of a motion ---------------------------------------

// A block's statement, without number and comment; empty where other lines continue it.
std::string_view statement_of(const gcode::Program& program, const gcode::Block& block) {
  const std::string_view text = program.source.text();
  const gcode::KlartextParts parts = gcode::klartext_parts(text, block.span);
  return parts.continues ? std::string_view() : program.source.text(parts.content);
}

std::optional<double> plain_value(std::string_view digits) {
  const auto number = gcode::read_number(digits);
  return number ? std::optional(number->value) : std::nullopt;
}

bool next_are(gcode::KlartextTokens& tokens, std::initializer_list<std::string_view> words) {
  return std::ranges::all_of(
      words, [&](std::string_view word) { return gcode::is_same_word(tokens.next(), word); });
}

// An empty word is the end of the statement.
bool begins_with(std::string_view statement, std::initializer_list<std::string_view> words) {
  gcode::KlartextTokens tokens(statement);
  return next_are(tokens, words);
}

// `TOOL CALL 5 Z S3000`, `TOOL CALL Z S4000`.
struct CalledTool {
  std::optional<double> number;  // none: the tool stays
  std::optional<double> speed;
};

// Nothing where the statement has more than number, Z, S and F, or where Z is missing: other tool
// axes, names, oversizes. F is left out: motions at the feed that a tool brings are not known.
std::optional<CalledTool> called_tool(std::string_view statement) {
  if (gcode::klartext_kind(statement) != gcode::KlartextKind::kToolCall) return std::nullopt;
  gcode::KlartextTokens tokens(statement);
  (void)tokens.next();  // TOOL
  (void)tokens.next();  // CALL
  CalledTool called;
  std::string_view token = tokens.next();
  if (const auto number = plain_value(token)) {
    called.number = number;
    token = tokens.next();
  }
  if (!gcode::is_same_word(token, "Z")) return std::nullopt;
  token = tokens.next();
  if (token.starts_with('S') || token.starts_with('s')) {
    called.speed = plain_value(token.substr(1));
    if (!called.speed) return std::nullopt;
    token = tokens.next();
  }
  const bool feed = token.starts_with('F') || token.starts_with('f');
  if (feed && plain_value(token.substr(1))) token = tokens.next();
  return token.empty() ? std::optional(called) : std::nullopt;
}

// Milliseconds, where the block is the first of two that say a dwell: `CYCL DEF 9.0 DWELL TIME` and
// `CYCL DEF 9.1 DWELL 1.5`, in seconds, with these or the words of another dialog language.
std::optional<std::int32_t> dwell_begun_in(const gcode::Program& program, std::uint32_t block) {
  if (block + 1 >= program.blocks.size()) return std::nullopt;
  const gcode::Block& first = program.blocks[block];
  const gcode::Block& second = program.blocks[block + 1];
  for (const gcode::Block* each : {&first, &second}) {
    if (each->opacity != gcode::ParseStatus::kForeign || each->block_delete) return std::nullopt;
  }
  gcode::KlartextTokens begin(statement_of(program, first));
  gcode::KlartextTokens words(statement_of(program, second));
  if (!next_are(begin, {"CYCL", "DEF", "9.0"}) || !next_are(words, {"CYCL", "DEF", "9.1"})) {
    return std::nullopt;
  }
  const std::string_view label = words.next();
  const std::string_view seconds = words.next();
  if (std::ranges::any_of(label, gcode::is_digit) || !words.next().empty()) return std::nullopt;
  constexpr double kMsPerSecond = 1000;
  constexpr double kRounding = 1e-6;
  const double exact = plain_value(seconds).value_or(0) * kMsPerSecond;
  const double ms = std::round(exact);
  const bool fits = ms >= 1 && ms <= gcode::kLongestDwellMs && std::abs(exact - ms) <= kRounding;
  return fits ? std::optional(static_cast<std::int32_t>(ms)) : std::nullopt;
}

// --- what a program has said so far -------------------------------------------------------------

// Spindle and coolant. Nothing: the program has not said it.
struct RunningFunctions {
  std::optional<bool> spindle;
  std::optional<bool> coolant;
  std::optional<double> speed;                        // since the tool was put in
  std::optional<gcode::SourceSpan> turned_at_change;  // of the tool; nothing said of it since

  [[nodiscard]] bool may_be_on() const { return spindle != false || coolant == true; }

  // M3, M4, M5, M8 or M9.
  void switch_by(int function) {
    const bool ends = function == 5 || function == 9;
    const bool of_coolant = function == 8 || function == 9;
    (of_coolant ? coolant : spindle) = !ends;
    if (!of_coolant) turned_at_change.reset();
  }

  // `where`: what puts the tool in. Whether the spindle turns after it is not known.
  void change_tool(gcode::SourceSpan where) {
    turned_at_change = spindle == true ? std::optional(where) : std::nullopt;
    spindle.reset();
    speed.reset();
  }
};

// The tool in the spindle, and whether its length counts.

enum class LengthSaid : std::uint8_t { kNot, kCounts, kCountsNot };

struct ToolInSpindle {
  std::optional<double> number;
  std::optional<Word> fetched;  // T without its M6 yet
  LengthSaid length = LengthSaid::kNot;
  std::optional<gcode::SourceSpan> without_length;  // G49, D0, and nothing moved since
  bool moved_along = false;                         // along Z, since the tool was put in

  // A whole number from 1 on.
  [[nodiscard]] static bool is_number(double number) {
    constexpr double kGreatest = 1e6;
    return number >= 1 && number < kGreatest && number == std::floor(number);
  }

  // `tool` is in the spindle from here on.
  void put_in(double tool) {
    *this = {};
    number = tool;
  }

  // The length does not count from here on.
  void leave_length(gcode::SourceSpan where) {
    without_length = where;
    length = LengthSaid::kCountsNot;
  }

  // The length counts from here on. Whether it did not before.
  bool count_length() {
    without_length.reset();
    return std::exchange(length, LengthSaid::kCounts) != LengthSaid::kCounts;
  }

  // Why G43, or a D word, is not just the length of the tool; empty where it is. `words`: of the
  // block. A control counts the length from where the tool is put in: that is the same as long as
  // nothing has moved along Z meanwhile.
  [[nodiscard]] std::string_view why_not_length(std::span<const Word> words) const {
    const Word* h = find_word(words, 'H');
    const std::optional<double> tool = tool_after(words);
    if (!tool) return kOfNoTool;
    if (h != nullptr && h->value != *tool) return "names the length of another tool";
    return why_too_late(words);
  }
  [[nodiscard]] std::string_view why_not_edge(const Word& d, std::span<const Word> words) const {
    if (d.value == 0) return {};
    if (d.value != 1) return "is another edge of the tool";
    return tool_after(words) ? why_too_late(words) : kOfNoTool;
  }

 private:
  // The tool in the spindle once the block's M6 is done.
  [[nodiscard]] std::optional<double> tool_after(std::span<const Word> words) const {
    if (find_word(words, 'M', word_code::kToolChange) == nullptr) return number;
    if (const Word* t = find_word(words, 'T')) return t->value;
    return fetched ? std::optional(fetched->value) : std::nullopt;
  }

  [[nodiscard]] std::string_view why_too_late(std::span<const Word> words) const {
    const bool changes = find_word(words, 'M', word_code::kToolChange) != nullptr;
    return moved_along && !changes ? "comes after a motion without the length of the tool" : "";
  }
};

// Why the motion cannot be said in another language; empty where it can. `state`: after its block.
std::string_view why_no_certain_motion(const Motion& motion, const gcode::ModalState& state,
                                       Language language) {
  if (state.distance == gcode::DistanceMode::kIncremental) return "is an increment";
  if (!path_alone_counts(state)) return "moves in a state in which its words are not the path";
  const bool arc = motion.kind == MotionKind::kArc;
  if (!motion.end_known || (arc && !motion.start_known)) {
    return "moves from a position that is not known";
  }
  if (motion.kind == MotionKind::kCurve) return "is a curve";
  if (motion.kind != MotionKind::kRapid && !state.feed) return "moves at a feed that is not known";
  return arc && language == Language::kSiemens && rises(*motion.piece.arc()) ? "is a helix" : "";
}

class OperationReader {
 public:
  OperationReader(const gcode::Program& program, const gcode::Interpretation& meaning)
      : program_(program), meaning_(meaning) {}

  ProgramOperations read() {
    for (std::uint32_t i = 0; i < program_.blocks.size(); ++i) read_block(i);
    return std::move(result_);
  }

 private:
  [[nodiscard]] bool in(Language language) const { return program_.language == language; }

  void read_block(std::uint32_t index) {
    block_ = index;
    told_ = false;
    const Block& block = program_.blocks[index];
    add_comments(block);
    if (block.opacity == gcode::ParseStatus::kProgramMark) return read_mark(block);
    if (in(Language::kKlartext) && read_statement(block)) return;
    const std::span<const Word> words = program_.words_of(block);
    if (const auto why = why_no_plain_block(block, meaning_.blocks[index]); !why.empty()) {
      return refuse(block.span, why);
    }
    if (std::ranges::all_of(words, [](const Word& word) { return word.letter == 'N'; }) &&
        block.opacity == gcode::ParseStatus::kNone) {
      return;
    }
    if (ended_) return refuse(block.span, "is after the end of the program");
    if (find_word(words, 'G', word_code::kDwell) != nullptr) return read_dwell(block, words);
    if (block.opacity == gcode::ParseStatus::kNamedWords) check_names(block);
    for (const Word& word : words) {
      if (const auto why = why_not(word, words); !why.empty()) refuse(word.span, why);
    }
    if (!told_) add_operations(words, meaning_.blocks[index]);
  }

  void refuse(gcode::SourceSpan where, std::string_view why) {
    if (!std::exchange(told_, true)) result_.obstacles.push_back({where, std::string(why)});
  }

  void read_dwell(const Block& block, std::span<const Word> words) {
    const auto ms = gcode::dwell_ms(words, program_.dwells);
    const bool plain = block.opacity == gcode::ParseStatus::kNone;
    plain&& ms ? (void)add(OperationKind::kDwell, block.span, *ms)
               : refuse(block.span, why_no_certain_dwell(words, program_.dwells));
  }

  // --- Klartext -----------------------------------------------------------------------------

  // BEGIN PGM and END PGM; other marks do nothing.
  void read_mark(const Block& block) {
    if (!in(Language::kKlartext)) return;
    const auto kind = gcode::klartext_kind(statement_of(program_, block));
    const gcode::ModalState& state = meaning_.states[meaning_.blocks[block_].state_after];
    if (kind == gcode::KlartextKind::kBegin && state.units == gcode::Units::kInch) {
      return refuse(block.span, "is in inches, where it is not certain what F means");
    }
    if (kind != gcode::KlartextKind::kEnd || std::exchange(ended_, true)) return;
    if (running_.may_be_on()) {
      return refuse(block.span, "ends without M2 or M30, and spindle or coolant may be on");
    }
    add(OperationKind::kEnd, block.span);
  }

  // Whether the block is a statement that is no plain words, and was read.
  bool read_statement(const Block& block) {
    if (block.opacity != gcode::ParseStatus::kForeign || block.block_delete || ended_) return false;
    const std::string_view statement = statement_of(program_, block);
    // The blank, which only the control's simulation shows.
    if (begins_with(statement, {"BLK", "FORM"})) {
      add(OperationKind::kBlank, block.span).text = statement;
      return true;
    }
    // Nothing moves, and no plane is tilted after it.
    if (begins_with(statement, {"PLANE", "RESET", "STAY", ""})) return true;
    if (const auto ms = dwell_begun_in(program_, block_)) {
      add(OperationKind::kDwell, block.span, *ms);
      return true;
    }
    if (block_ > 0 && dwell_begun_in(program_, block_ - 1)) return true;
    const auto called = called_tool(statement);
    if (!called) return false;
    if (called->number) {
      if (!ToolInSpindle::is_number(*called->number)) return false;
      put_in(*called->number, block.span);
    }
    if (called->speed) set_speed(*called->speed, block.span);
    return true;
  }

  // A remark of a translation stands for what it says.
  bool read_remark(std::string_view text, gcode::SourceSpan where) {
    if (!in(Language::kKlartext)) return false;
    const bool no_length = text == kLengthRemark;
    if (no_length || text == kUnsaidLengthRemark) {
      tool_.length = LengthSaid::kCountsNot;
      add(no_length ? OperationKind::kNoLength : OperationKind::kLengthUnsaid, where);
      return true;
    }
    for (int offset = 54; offset <= 59; ++offset) {
      if (text != datum_remark(offset)) continue;
      const std::string_view why = why_not_work_offset(offset * 10);
      why.empty() ? set_work_offset(offset * 10, where) : refuse(where, why);
      return true;
    }
    return false;
  }

  // --- what can be said ---------------------------------------------------------------------

  void check_names(const Block& block) {
    // Units, edges of tools, and ends of what was refused where it began.
    constexpr std::array<std::string_view, 7> kSayable = {"G71",    "G700",    "G710",  "D",
                                                          "COMPOF", "TRAFOOF", "DIAMOF"};
    for (const gcode::SiemensName& each :
         gcode::siemens_names_in(program_.source.text(), block.span)) {
      if (std::ranges::find(kSayable, each.name) != kSayable.end()) continue;
      return refuse(each.span, each.name == "G70" ? "leaves feeds in millimetres"
                                                  : "is a word that only Siemens controls have");
    }
    const gcode::BlockWords words(program_.words_of(block));
    if (words.problem() != gcode::BlockWords::Problem::kNone) {
      refuse(block.span, "is not understood");
    }
  }

  [[nodiscard]] std::string_view why_not(const Word& word, std::span<const Word> words) const {
    if (!word.is_number) return "has no plain number";
    const int code = gcode::code_of(word);
    bool certain = is_certain_letter(word.letter, program_.language);
    switch (word.letter) {
      case 'G':
        return why_not_g(code, words);
      case 'M':
        certain = is_certain_function(code, program_.language);
        break;
      case 'H':
        certain = find_word(words, 'G', word_code::kToolLengthOn) != nullptr;
        break;
      case 'D':
        if (in(Language::kSiemens)) return tool_.why_not_edge(word, words);
        break;
      case 'T':
        return ToolInSpindle::is_number(word.value) ? "" : "is no tool there";
      default:
        break;
    }
    if (!certain) return kOtherThere;
    return is_place_letter(word.letter) && !moves_with(word) ? "says nothing that is certain" : "";
  }

  [[nodiscard]] bool moves_with(const Word& word) const {
    const std::int32_t motion = meaning_.blocks[block_].motion;
    if (motion < 0) return false;
    return !is_arc_letter(word.letter) || motion_at(motion).kind == MotionKind::kArc;
  }

  [[nodiscard]] std::string_view why_not_g(int code, std::span<const Word> words) const {
    const gcode::CodeRow& row = gcode::row_of_g(code);
    if (row.is(gcode::trait::kSilent) || code == word_code::kToolLengthOff) return {};
    if (names_work_offset(code)) return why_not_work_offset(code);
    if (code == word_code::kToolLengthOn) return tool_.why_not_length(words);
    // G41 and G42; G41.1 is a word of some controls alone.
    if (row.group == gcode::CodeGroup::kCutter && code % 10 == 0)
      return "moves beside the path by the radius of the tool";
    if (code != word_code::kBlending) return kOtherThere;
    const bool plain = std::ranges::none_of(words, [](const Word& word) {
      return std::string_view("PQRL").find(word.letter) != std::string_view::npos;
    });
    return plain ? "" : "says how far corners may be rounded, which is no word there";
  }

  [[nodiscard]] std::string_view why_not_work_offset(int code) const {
    if (work_offset_ == code) return {};
    if (work_offset_) return "names another work offset";
    return moved_ ? "names a work offset after the first motion" : "";
  }

  // --- acts ---------------------------------------------------------------------------------

  void add_comments(const Block& block) {
    for (const gcode::Comment& comment : program_.comments_of(block)) {
      if (comment.kind == gcode::CommentKind::kActive) {
        refuse(comment.span, "acts on its control");
        continue;
      }
      const std::string_view text = text_of_comment(program_.source.text(comment.span));
      // The folder of a Siemens program.
      if (in(Language::kSiemens) && text.starts_with("$PATH")) continue;
      if (!read_remark(text, comment.span)) add(OperationKind::kComment, comment.span).text = text;
    }
  }

  void add_operations(std::span<const Word> words, const BlockMeaning& meaning) {
    const bool moves = meaning.motion >= 0;
    // Klartext says of each function whether it acts before or after the motion of its block.
    const bool known_order = in(Language::kKlartext);
    if (const Word* t = find_word(words, 'T')) tool_.fetched = *t;
    if (const Word* change = find_word(words, 'M', word_code::kToolChange)) change_tool(*change);
    if (const Word* s = find_word(words, 'S')) add_speed(*s, meaning);
    for (const int code : {30, 130, 40, 140, 80}) {
      if (const Word* word = find_word(words, 'M', code)) add_start(*word);
    }
    if (!moves || !known_order) add_stops(words, moves);
    for (const Word& word : words) {
      if (word.letter == 'G') add_g(word);
      if (word.letter == 'D') add_edge(word);
    }
    if (moves) add_motion(meaning);
    if (moves && known_order) add_stops(words, false);
    for (const int code : {0, 10}) {
      if (const Word* word = find_word(words, 'M', code)) add_pause(*word, moves);
    }
    for (const int code : {20, 300}) {
      if (const Word* word = find_word(words, 'M', code)) add_end(*word);
    }
  }

  Operation& add(OperationKind kind, gcode::SourceSpan where, double number = 0) {
    return result_.operations.emplace_back(Operation{kind, block_, where, number});
  }

  void change_tool(const Word& word) {
    if (!tool_.fetched) return refuse(word.span, "names no tool");
    put_in(tool_.fetched->value, word.span);
  }

  void put_in(double tool, gcode::SourceSpan where) {
    tool_.put_in(tool);
    running_.change_tool(where);
    add(OperationKind::kTool, where, tool);
  }

  void add_speed(const Word& word, const BlockMeaning& meaning) {
    const bool cuts = meaning.motion >= 0 && motion_at(meaning.motion).kind != MotionKind::kRapid;
    if (cuts && running_.speed != word.value) {
      return refuse(word.span, "changes the speed in a cutting move");
    }
    set_speed(word.value, word.span);
  }

  void set_speed(double speed, gcode::SourceSpan where) {
    if (running_.speed == speed) return;
    if (speed < 0) return refuse(where, "is no speed there");
    running_.speed = speed;
    add(OperationKind::kSpeed, where, speed);
  }

  // M3, M4, M8; M13 and M14 are two of them.
  void add_start(const Word& word) {
    const auto code = static_cast<int>(word.value);
    if (code != 8) add_function(code % 10, word.span);
    if (code == 8 || code > 10) add_function(8, word.span);
  }

  void add_stops(std::span<const Word> words, bool beside_motion) {
    for (const int code : {50, 90}) {
      const Word* word = find_word(words, 'M', code);
      if (word == nullptr) continue;
      beside_motion
          ? refuse(word->span, "acts before or after the motion of its block: controls differ")
          : add_function(code / 10, word->span);
    }
  }

  void add_function(int code, gcode::SourceSpan where) {
    running_.switch_by(code);
    add(OperationKind::kFunction, where, code);
  }

  void add_pause(const Word& word, bool moves) {
    if (moves) return refuse(word.span, "acts before or after the motion of its block");
    if (running_.may_be_on()) {
      return refuse(word.span, "stops spindle and coolant on some controls, and they may be on");
    }
    add(OperationKind::kFunction, word.span, word.value);
  }

  void add_end(const Word& word) {
    ended_ = true;
    add(OperationKind::kEnd, word.span, word.value);
  }

  void add_g(const Word& word) {
    const int code = gcode::code_of(word);
    if (code == word_code::kToolLengthOff) tool_.leave_length(word.span);
    if (code == word_code::kToolLengthOn) count_length(word.span);
    if (code == word_code::kBlending) add(OperationKind::kBlending, word.span);
    if (names_work_offset(code)) set_work_offset(code, word.span);
  }

  void add_edge(const Word& word) {
    word.value == 0 ? tool_.leave_length(word.span) : count_length(word.span);
  }

  void count_length(gcode::SourceSpan where) {
    if (tool_.count_length()) add(OperationKind::kLength, where, *tool_.number);
  }

  void set_work_offset(int code, gcode::SourceSpan where) {
    if (work_offset_ == code) return;
    work_offset_ = code;
    const int number = code / 10;  // codes are tenths
    add(OperationKind::kWorkOffset, where, number);
  }

  // --- motions ------------------------------------------------------------------------------

  void add_motion(const BlockMeaning& meaning) {
    const gcode::SourceSpan here = program_.blocks[block_].span;
    const Motion& motion = motion_at(meaning.motion);
    const gcode::ModalState& state = meaning_.states[meaning.state_after];
    if (tool_.fetched) {
      refuse(tool_.fetched->span,
             "changes the tool on some controls, and on others only fetches it");
      return tool_.fetched.reset();
    }
    say_length_before(motion, here);
    if (const auto why = why_no_certain_motion(motion, state, program_.language); !why.empty()) {
      return refuse(here, why);
    }
    if (motion.kind != MotionKind::kRapid && running_.turned_at_change) {
      refuse(*std::exchange(running_.turned_at_change, std::nullopt),
             "finds the spindle on, and controls differ in whether it turns in the cut after it");
    }
    Operation& operation = add(OperationKind::kMotion, here);
    operation.motion = meaning.motion;
    if (motion.kind != MotionKind::kRapid) operation.feed = state.feed;
    moved_ = true;
    tool_.moved_along |= motion.axes_named[2];
  }

  // What holds for the tool's length, before the first motion that it makes a difference to.
  void say_length_before(const Motion& motion, gcode::SourceSpan here) {
    if (tool_.without_length) add(OperationKind::kNoLength, *tool_.without_length);
    tool_.without_length.reset();
    if (!tool_.number || tool_.length != LengthSaid::kNot || !motion.axes_named[2]) return;
    if (in(Language::kKlartext)) return count_length(here);
    tool_.length = LengthSaid::kCountsNot;
    add(OperationKind::kLengthUnsaid, here);
  }

  [[nodiscard]] const Motion& motion_at(std::int32_t index) const {
    return meaning_.motions[static_cast<std::size_t>(index)];
  }

  const gcode::Program& program_;
  const gcode::Interpretation& meaning_;
  ProgramOperations result_;
  std::uint32_t block_ = 0;
  bool told_ = false;  // the block has its obstacle
  bool ended_ = false;
  bool moved_ = false;
  ToolInSpindle tool_;
  RunningFunctions running_;
  std::optional<int> work_offset_;  // in tenths
};

}  // namespace

ProgramOperations operations_of(const gcode::Program& program,
                                const gcode::Interpretation& meaning) {
  return OperationReader(program, meaning).read();
}

}  // namespace batten::postproc
