#include "postproc/convert/program_operations.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "gcode/klartext/statement.h"
#include "gcode/siemens/block.h"
#include "gcode/state/block_words.h"
#include "gcode/state/dwell.h"
#include "postproc/convert/klartext_statements.h"
#include "postproc/convert/portable_words.h"

namespace batten::postproc {
namespace {

using gcode::Block;
using gcode::BlockMeaning;
using gcode::Language;
using gcode::Motion;
using gcode::MotionKind;
using gcode::Word;

// Spindle and coolant while a program is read.

// Nothing: the program has not said it.
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

  // `where`: what puts the tool in. Whether the spindle turns behind it is not known.
  void change_tool(gcode::SourceSpan where) {
    turned_at_change = spindle == true ? std::optional(where) : std::nullopt;
    spindle.reset();
    speed.reset();
  }
};

// The tool in the spindle while a program is read, and whether its length counts.

constexpr std::string_view kOfNoTool = "names the length of a tool that no M6 has put in";

enum class LengthSaid : std::uint8_t { kNot, kCounts, kCountsNot };

struct FetchedTool {
  double number = 0;
  gcode::SourceSpan where;
};

struct ToolInSpindle {
  std::optional<double> number;
  std::optional<FetchedTool> fetched;  // T without its M6 yet
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
    const Word* h = first_word(words, 'H');
    const std::optional<double> tool = behind(words);
    if (!tool) return kOfNoTool;
    if (h != nullptr && h->value != *tool) return "names the length of another tool";
    return why_too_late(words);
  }
  [[nodiscard]] std::string_view why_not_edge(const Word& d, std::span<const Word> words) const {
    if (d.value == 0) return {};
    if (d.value != 1) return "is another edge of the tool";
    return behind(words) ? why_too_late(words) : kOfNoTool;
  }

 private:
  // The tool in the spindle once the block's M6 is done.
  [[nodiscard]] std::optional<double> behind(std::span<const Word> words) const {
    if (coded_word(words, 'M', word_code::kToolChange) == nullptr) return number;
    if (const Word* t = first_word(words, 'T')) return t->value;
    return fetched ? std::optional(fetched->number) : std::nullopt;
  }

  [[nodiscard]] std::string_view why_too_late(std::span<const Word> words) const {
    const bool changes = coded_word(words, 'M', word_code::kToolChange) != nullptr;
    return moved_along && !changes ? "comes after a motion without the length of the tool" : "";
  }
};

// mm: an arc that rises by more is a helix.
constexpr double kLevelArc = 1e-9;

bool rises(const geometry::Arc& arc) {
  return std::abs(arc.axis.dot(arc.end - arc.start)) > kLevelArc;
}

// Why the motion cannot be said in another language; empty where it can. `state`: behind its block.
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
  if (arc && language == Language::kSiemens && rises(*motion.piece.arc())) {
    return "is a helix";
  }
  return {};
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
      return refuse(block.span, std::string(why));
    }
    if (std::ranges::all_of(words, [](const Word& word) { return word.letter == 'N'; }) &&
        block.opacity == gcode::ParseStatus::kNone) {
      return;
    }
    if (ended_) return refuse(block.span, "is after the end of the program");
    if (coded_word(words, 'G', word_code::kDwell) != nullptr) return read_dwell(block, words);
    if (block.opacity == gcode::ParseStatus::kNamedWords) check_names(block);
    for (const Word& word : words) {
      if (std::string why = why_not(word, words); !why.empty()) refuse(word.span, std::move(why));
    }
    if (!told_) add_operations(words, meaning_.blocks[index]);
  }

  void refuse(gcode::SourceSpan where, std::string why) {
    if (!std::exchange(told_, true)) result_.obstacles.push_back({where, std::move(why)});
  }

  void read_dwell(const Block& block, std::span<const Word> words) {
    const auto ms = gcode::dwell_ms(words, program_.dwells);
    const bool plain = block.opacity == gcode::ParseStatus::kNone;
    if (plain && ms) return (void)add(OperationKind::kDwell, block.span, *ms);
    refuse(block.span, std::string(why_no_certain_dwell(words, program_.dwells)));
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
    (void)add(OperationKind::kEnd, block.span);
  }

  // Whether the block is a statement that is no plain words, and was read.
  bool read_statement(const Block& block) {
    if (block.opacity != gcode::ParseStatus::kForeign || block.block_delete || ended_) return false;
    const std::string_view statement = statement_of(program_, block);
    if (defines_stock(statement)) {
      add(OperationKind::kBlank, block.span).text = statement;
      return true;
    }
    if (ends_tilting(statement)) return true;
    if (const auto ms = dwell_begun_in(program_, block_)) {
      (void)add(OperationKind::kDwell, block.span, *ms);
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
      (void)add(no_length ? OperationKind::kNoLength : OperationKind::kLengthUnsaid, where);
      return true;
    }
    const auto datum = datum_of_remark(text);
    if (!datum) return false;
    const std::string why = why_not_work_offset(*datum * 10);
    why.empty() ? set_work_offset(*datum * 10, where) : refuse(where, why);
    return true;
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

  [[nodiscard]] std::string why_not(const Word& word, std::span<const Word> words) const {
    if (!word.is_number) return "has no plain number";
    switch (word.letter) {
      case 'G':
        return why_not_g(gcode::code_of(word), words);
      case 'M':
        return is_certain_function(gcode::code_of(word), program_.language)
                   ? ""
                   : "may mean something else there";
      case 'H':
        return coded_word(words, 'G', word_code::kToolLengthOn) != nullptr
                   ? ""
                   : "may mean something else there";
      case 'D':
        if (in(Language::kSiemens)) return std::string(tool_.why_not_edge(word, words));
        break;
      case 'T':
        return ToolInSpindle::is_number(word.value) ? "" : "is no tool there";
      default:
        break;
    }
    if (!is_certain_letter(word.letter, program_.language)) return "may mean something else there";
    if (is_place_letter(word.letter) && !moves_with(word)) return "says nothing that is certain";
    return {};
  }

  [[nodiscard]] bool moves_with(const Word& word) const {
    const std::int32_t motion = meaning_.blocks[block_].motion;
    if (motion < 0) return false;
    return !is_arc_letter(word.letter) || motion_at(motion).kind == MotionKind::kArc;
  }

  [[nodiscard]] std::string why_not_g(int code, std::span<const Word> words) const {
    const gcode::CodeRow& row = gcode::row_of_g(code);
    if (row.is(gcode::trait::kSilent)) return {};
    if (names_work_offset(code)) return why_not_work_offset(code);
    if (code == word_code::kToolLengthOn) return std::string(tool_.why_not_length(words));
    if (code == word_code::kToolLengthOff) return {};
    // G41 and G42; G41.1 is a word of some controls alone.
    if (row.group == gcode::CodeGroup::kCutter && code % 10 == 0)
      return "moves beside the path by the radius of the tool";
    if (code == word_code::kBlending) {
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
    if (const Word* t = first_word(words, 'T')) tool_.fetched = {t->value, t->span};
    if (const Word* change = coded_word(words, 'M', word_code::kToolChange)) change_tool(*change);
    if (const Word* s = first_word(words, 'S')) add_speed(*s, meaning);
    for (const int code : {30, 130, 40, 140, 80}) {
      if (const Word* word = coded_word(words, 'M', code)) add_start(*word);
    }
    if (!moves || !known_order) add_stops(words, moves);
    for (const Word& word : words) {
      if (word.letter == 'G') add_g(word);
      if (word.letter == 'D') add_edge(word);
    }
    if (moves) add_motion(meaning);
    if (moves && known_order) add_stops(words, false);
    for (const int code : {0, 10}) {
      if (const Word* word = coded_word(words, 'M', code)) add_pause(*word, moves);
    }
    for (const int code : {20, 300}) {
      if (const Word* word = coded_word(words, 'M', code)) add_end(*word);
    }
  }

  Operation& add(OperationKind kind, gcode::SourceSpan where, double number = 0) {
    Operation operation;
    operation.kind = kind;
    operation.block = block_;
    operation.where = where;
    operation.number = number;
    result_.operations.push_back(operation);
    return result_.operations.back();
  }

  void change_tool(const Word& word) {
    if (!tool_.fetched) return refuse(word.span, "names no tool");
    put_in(tool_.fetched->number, word.span);
  }

  void put_in(double tool, gcode::SourceSpan where) {
    tool_.put_in(tool);
    running_.change_tool(where);
    (void)add(OperationKind::kTool, where, tool);
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
    (void)add(OperationKind::kSpeed, where, speed);
  }

  // M3, M4, M8; M13 and M14 are two of them.
  void add_start(const Word& word) {
    const auto code = static_cast<int>(word.value);
    if (code != 8) add_function(code % 10, word.span);
    if (code == 8 || code > 10) add_function(8, word.span);
  }

  void add_stops(std::span<const Word> words, bool beside_motion) {
    for (const int code : {50, 90}) {
      const Word* word = coded_word(words, 'M', code);
      if (word == nullptr) continue;
      beside_motion
          ? refuse(word->span, "acts before or after the motion of its block: controls differ")
          : add_function(code / 10, word->span);
    }
  }

  void add_function(int code, gcode::SourceSpan where) {
    running_.switch_by(code);
    (void)add(OperationKind::kFunction, where, code);
  }

  void add_pause(const Word& word, bool moves) {
    if (moves) return refuse(word.span, "acts before or after the motion of its block");
    if (running_.may_be_on()) {
      return refuse(word.span, "stops spindle and coolant on some controls, and they may be on");
    }
    (void)add(OperationKind::kFunction, word.span, word.value);
  }

  void add_end(const Word& word) {
    ended_ = true;
    (void)add(OperationKind::kEnd, word.span, word.value);
  }

  void add_g(const Word& word) {
    const int code = gcode::code_of(word);
    if (code == word_code::kToolLengthOff) tool_.leave_length(word.span);
    if (code == word_code::kToolLengthOn) count_length(word.span);
    if (code == word_code::kBlending) (void)add(OperationKind::kBlending, word.span);
    if (names_work_offset(code)) set_work_offset(code, word.span);
  }

  void add_edge(const Word& word) {
    word.value == 0 ? tool_.leave_length(word.span) : count_length(word.span);
  }

  void count_length(gcode::SourceSpan where) {
    if (tool_.count_length()) (void)add(OperationKind::kLength, where, *tool_.number);
  }

  void set_work_offset(int code, gcode::SourceSpan where) {
    if (work_offset_ == code) return;
    work_offset_ = code;
    const int number = code / 10;  // codes are tenths
    (void)add(OperationKind::kWorkOffset, where, number);
  }

  // --- motions ------------------------------------------------------------------------------

  void add_motion(const BlockMeaning& meaning) {
    const gcode::SourceSpan here = program_.blocks[block_].span;
    const Motion& motion = motion_at(meaning.motion);
    const gcode::ModalState& state = meaning_.states[meaning.state_after];
    if (tool_.fetched) {
      refuse(tool_.fetched->where,
             "changes the tool on some controls, and on others only fetches it");
      return tool_.fetched.reset();
    }
    say_length_before(motion, here);
    if (const auto why = why_no_certain_motion(motion, state, program_.language); !why.empty()) {
      return refuse(here, std::string(why));
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
    if (tool_.without_length) (void)add(OperationKind::kNoLength, *tool_.without_length);
    tool_.without_length.reset();
    if (!tool_.number || tool_.length != LengthSaid::kNot || !motion.axes_named[2]) return;
    if (in(Language::kKlartext)) return count_length(here);
    tool_.length = LengthSaid::kCountsNot;
    (void)add(OperationKind::kLengthUnsaid, here);
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
