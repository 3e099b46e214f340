#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "gcode/state/dwell.h"
#include "postproc/convert/klartext_statements.h"
#include "postproc/convert/plain_moves.h"
#include "postproc/convert/translation.h"

namespace batten::postproc {
namespace {

constexpr gcode::NumberFormat kSpeedFormat = {.decimals = 3};

class PlainSpeaker {
 public:
  PlainSpeaker(const TranslationSource& source, const gcode::Control& target, std::string_view name)
      : source_(source),
        target_(target),
        siemens_(target.language == gcode::Language::kSiemens),
        name_(name),
        moves_(target, text_) {}

  Translation say() {
    begin();
    const auto& operations = source_.operations.operations;
    for (std::size_t i = 0; i < operations.size(); ++i) {
      line_ = line_of(operations[i]);
      say_operation(operations[i], i);
    }
    check_end();
    if (is_framed()) text_.add("%", line_);
    return text_.take();
  }

 private:
  [[nodiscard]] std::uint32_t line_of(const Operation& operation) const {
    return source_.program.blocks[operation.block].line;
  }

  [[nodiscard]] const gcode::Motion& motion_of(const Operation& operation) const {
    return source_.meaning.motions[static_cast<std::size_t>(operation.motion)];
  }

  [[nodiscard]] gcode::Units units_of(const Operation& operation) const {
    return source_.meaning.states[source_.meaning.blocks[operation.block].state_after].units;
  }

  // --- the frame ----------------------------------------------------------------------------

  // Controls that read FANUC's macros read its files: %, O0001, the program, %.
  [[nodiscard]] bool is_framed() const {
    constexpr gcode::SourceMarks kOfFanuc = gcode::mark(gcode::SourceMark::kMacroFlow);
    return target_.known_marks != gcode::kAllMarks && (target_.known_marks & kOfFanuc) != 0;
  }

  void begin() {
    if (siemens_) text_.add(fmt::format("%_N_{}_MPF", name_), 1);
    if (is_framed()) {
      text_.add("%", 1);
      text_.add(fmt::format("O{:04}", number_of_program()), 1);
    }
    const auto& operations = source_.operations.operations;
    const auto first = std::ranges::find(operations, OperationKind::kMotion, &Operation::kind);
    if (first == operations.end()) return;
    say_units(*first);
    std::string line(siemens_ ? "" : moves_.unit_word());
    for (const int code : {170, 400, 900, 940}) {
      // A control that refuses the word has no other mode.
      if (refuses_word(target_, 'G', code)) continue;
      line += fmt::format("{}G{}", line.empty() ? "" : " ", code / 10);
    }
    text_.add(line, 1);
  }

  [[nodiscard]] int number_of_program() const {
    constexpr std::size_t kMostDigits = 4;
    int number = 0;
    const char* end = name_.data() + name_.size();
    const auto read = std::from_chars(name_.data(), end, number);
    const bool is_number = read.ec == std::errc{} && read.ptr == end && number > 0;
    return is_number && name_.size() <= kMostDigits ? number : 1;
  }

  // Programs of plain words end by a word.
  void check_end() {
    const auto& operations = source_.operations.operations;
    const auto& blocks = source_.program.blocks;
    const bool ends =
        std::ranges::find(operations, OperationKind::kEnd, &Operation::kind) != operations.end();
    if (siemens_ || ends || blocks.empty() || !source_.operations.obstacles.empty()) return;
    text_.refuse(blocks.back().span, "ends the program without M2 or M30");
  }

  // Siemens words for units stand in a block of their own.
  void say_units(const Operation& operation) {
    moves_.use_units(units_of(operation));
    if (const auto meaning = moves_.other_meaning_of_units(); !meaning.empty()) {
      text_.refuse(operation.where, fmt::format("needs {}: {}", moves_.unit_word(), meaning));
    }
    if (siemens_) text_.add(moves_.unit_word(), line_);
  }

  // --- acts ---------------------------------------------------------------------------------

  void say_operation(const Operation& operation, std::size_t index) {
    switch (operation.kind) {
      case OperationKind::kComment:
        return say_comment(operation);
      case OperationKind::kBlank:
        return say_blank(operation);
      case OperationKind::kBlending:
        if (siemens_) text_.add("G64", line_);
        return;
      case OperationKind::kWorkOffset:
        return say_work_offset(operation);
      case OperationKind::kNoLength:
        return say_no_length(operation);
      case OperationKind::kLengthUnsaid:
        return say_unsaid_length(operation);
      case OperationKind::kTool:
        return say_tool(operation, index);
      case OperationKind::kLength:
        return;  // said behind its tool, or in the next motion
      case OperationKind::kSpeed:
        return say_speed(operation, index);
      case OperationKind::kDwell:
        return say_dwell(operation);
      case OperationKind::kFunction:
        return say_function(operation);
      case OperationKind::kMotion:
        return say_motion(operation);
      case OperationKind::kEnd:
        return say_end(operation);
    }
  }

  void say_comment(const Operation& operation) {
    if (!text_.add_comment_of(target_, operation.text, line_)) {
      text_.refuse(operation.where, "is no comment there");
    }
  }

  void say_blank(const Operation& operation) {
    if (!source_.blank_is_remark) {
      return text_.refuse(operation.where,
                          "draws the blank for the simulation, which has no word there; --allow "
                          "blank-form leaves it as a comment");
    }
    say_comment(operation);
  }

  // Whether the target takes the word; tells where it does not.
  bool takes(const Operation& operation, char letter, int tenths) {
    if (!refuses_word(target_, letter, tenths)) return true;
    text_.refuse(operation.where,
                 fmt::format("needs {}{}, which is not taken there", letter, tenths / 10));
    return false;
  }

  void say_work_offset(const Operation& operation) {
    const auto code = static_cast<int>(operation.number);
    if (siemens_ && code > 57) return text_.refuse(operation.where, "is another offset there");
    if (takes(operation, 'G', code * 10)) text_.add(fmt::format("G{}", code), line_);
  }

  void say_no_length(const Operation& operation) {
    if (siemens_) return text_.add("D0", line_);
    if (takes(operation, 'G', 490)) text_.add("G49", line_);
  }

  void say_unsaid_length(const Operation& operation) {
    if (source_.program.language != gcode::Language::kSiemens) return;
    text_.refuse(operation.where,
                 "moves along Z behind a tool change without D, where the control's data say "
                 "whether the length of the tool counts");
  }

  void say_tool(const Operation& operation, std::size_t index) {
    if (!takes(operation, 'M', 60) || !takes(operation, 'T', whole(operation) * 10)) return;
    text_.add(fmt::format("T{} M6", whole(operation)), line_);
    moves_.forget_modes();
    say_length(operation, index);
  }

  // Behind the tool, since nothing moves along Z before its length counts; in the first motion
  // where that goes along Z, as controls want it that move to the length at once.
  void say_length(const Operation& tool, std::size_t index) {
    const auto& operations = source_.operations.operations;
    const Operation* motion = nullptr;
    for (std::size_t i = index + 1;
         i < operations.size() && operations[i].kind != OperationKind::kTool; ++i) {
      if (operations[i].kind == OperationKind::kMotion && motion == nullptr)
        motion = &operations[i];
      if (operations[i].kind != OperationKind::kLength) continue;
      if (siemens_) return text_.add("D1", line_);
      if (!takes(tool, 'G', 430) || !takes(tool, 'H', whole(tool) * 10)) return;
      const std::string words = fmt::format("G43 H{}", whole(tool));
      if (motion == nullptr) motion = next_motion(i);
      const bool along_z = motion != nullptr && motion_of(*motion).axes_named[2] &&
                           motion_of(*motion).kind != gcode::MotionKind::kArc;
      if (along_z) return moves_.say_before_next(words);
      return text_.add(words, line_);
    }
  }

  [[nodiscard]] const Operation* next_motion(std::size_t index) const {
    const auto& operations = source_.operations.operations;
    for (std::size_t i = index; i < operations.size() && operations[i].kind != OperationKind::kTool;
         ++i) {
      if (operations[i].kind == OperationKind::kMotion) return &operations[i];
    }
    return nullptr;
  }

  static int whole(const Operation& operation) { return static_cast<int>(operation.number); }

  // In the block of M3 or M4 where that comes next.
  void say_speed(const Operation& operation, std::size_t index) {
    if (!takes(operation, 'S', whole(operation) * 10)) return;
    const std::string speed = "S" + gcode::to_text(operation.number, kSpeedFormat);
    const auto& operations = source_.operations.operations;
    const bool turns = index + 1 < operations.size() &&
                       operations[index + 1].kind == OperationKind::kFunction &&
                       (operations[index + 1].number == 3 || operations[index + 1].number == 4);
    if (turns) {
      said_speed_ = speed + " ";
    } else {
      text_.add(speed, line_);
    }
  }

  void say_function(const Operation& operation) {
    if (!takes(operation, 'M', whole(operation) * 10)) return;
    text_.add(fmt::format("{}M{}", said_speed_, whole(operation)), line_);
    said_speed_.clear();
  }

  void say_dwell(const Operation& operation) {
    const std::string block = gcode::dwell_block(whole(operation), target_.dwell_form);
    if (block.empty()) {
      return text_.refuse(operation.where,
                          fmt::format("waits for {} s, and how that is said there is not "
                                      "certain",
                                      gcode::dwell_seconds(whole(operation), false)));
    }
    text_.add(block, line_);
  }

  void say_motion(const Operation& operation) {
    if (moves_.units() != units_of(operation)) {
      say_units(operation);
      if (!siemens_) text_.add(moves_.unit_word(), line_);
    }
    const std::string why = moves_.say(motion_of(operation), operation.feed, line_);
    if (!why.empty()) text_.refuse(operation.where, why);
  }

  void say_end(const Operation& operation) {
    constexpr int kEnd = 30;
    const int code = operation.number == 0 ? kEnd : whole(operation);
    if (!takes(operation, 'M', code * 10)) return;
    if (operation.number == 0 && !text_.add_comment_of(target_, kEndRemark, line_)) {
      return text_.refuse(operation.where, "ends without M30, which needs a comment there");
    }
    text_.add(fmt::format("M{}", code), line_);
  }

  const TranslationSource& source_;
  const gcode::Control& target_;
  bool siemens_;
  std::string name_;
  TranslationText text_;
  PlainMoves moves_;
  std::uint32_t line_ = 1;
  std::string said_speed_;  // for the M3 or M4 that comes next
};

}  // namespace

Translation in_plain_words(const TranslationSource& source, const gcode::Control& target,
                           std::string_view name) {
  return PlainSpeaker(source, target, name).say();
}

}  // namespace batten::postproc
