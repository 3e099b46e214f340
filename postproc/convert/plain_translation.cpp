#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include "gcode/control/block_spelling.h"
#include "gcode/controls/arc_rules.h"
#include "gcode/state/dwell.h"
#include "gcode/writer/writer.h"
#include "postproc/convert/translation.h"

namespace batten::postproc {
namespace {

using gcode::MotionMode;

constexpr gcode::NumberFormat kSpeedFormat = {.decimals = 3};

// mm: how far the arc leaves so many chords of equal length.
double sagitta_of(const geometry::Arc& arc, int chords) {
  const geometry::Vector3 from_center = arc.start - arc.center;
  const double radius = (from_center - from_center.dot(arc.axis) * arc.axis).norm();
  const double half = std::abs(arc.sweep) / 2 / chords;
  return radius * (1 - std::cos(std::min(half, std::numbers::pi)));
}

class PlainSpeaker {
 public:
  PlainSpeaker(const TranslationSource& source, const gcode::Control& target, std::string_view name)
      : source_(source),
        operations_(source.operations.operations),
        target_(target),
        siemens_(target.language == gcode::Language::kSiemens),
        name_(name) {
    modal_.units = gcode::Units::kMillimetre;
  }

  Translation say() {
    begin();
    for (std::size_t i = 0; i < operations_.size(); ++i) {
      line_ = source_.program.blocks[operations_[i].block].line;
      say_operation(operations_[i], i);
    }
    check_end();
    if (is_framed()) text_.add("%", line_);
    return text_.take();
  }

 private:
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
    return (target_.known_marks & kOfFanuc) != 0;
  }

  void begin() {
    if (siemens_) text_.add(fmt::format("%_N_{}_MPF", name_), 1);
    if (is_framed()) {
      text_.add("%", 1);
      text_.add(fmt::format("O{:04}", number_of_program()), 1);
    }
    const auto first = std::ranges::find(operations_, OperationKind::kMotion, &Operation::kind);
    if (first == operations_.end()) return;
    say_units(*first);
    std::string line(siemens_ ? "" : unit_word_);
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
    const auto& blocks = source_.program.blocks;
    const bool ends =
        std::ranges::find(operations_, OperationKind::kEnd, &Operation::kind) != operations_.end();
    if (siemens_ || ends || blocks.empty() || !source_.operations.obstacles.empty()) return;
    text_.refuse(blocks.back().span, "ends the program without M2 or M30");
  }

  // The target's own words for G21 and G20; Siemens words for units have a block of their own.
  void say_units(const Operation& operation) {
    modal_.units = units_of(operation) == gcode::Units::kInch ? gcode::Units::kInch
                                                              : gcode::Units::kMillimetre;
    unit_ = gcode::millimetres_per(modal_.units);
    modal_.feed.reset();
    unit_word_ = gcode::unit_word(target_, modal_.units);
    const std::string_view meaning = unit_word_ == "G20"   ? other_meaning(target_, 200)
                                     : unit_word_ == "G21" ? other_meaning(target_, 210)
                                                           : "";
    if (!meaning.empty()) {
      text_.refuse(operation.where, fmt::format("needs {}: {}", unit_word_, meaning));
    }
    if (siemens_) text_.add(unit_word_, line_);
  }

  // --- acts ---------------------------------------------------------------------------------

  void say_operation(const Operation& operation, std::size_t index) {
    switch (operation.kind) {
      case OperationKind::kComment:
      case OperationKind::kBlank:
        return say_comment(operation);
      case OperationKind::kBlending:
        if (siemens_) text_.add("G64", line_);
        return;
      case OperationKind::kWorkOffset:
        return say_work_offset(operation);
      case OperationKind::kNoLength:
        if (siemens_ || takes(operation, 'G', 490)) text_.add(siemens_ ? "D0" : "G49", line_);
        return;
      case OperationKind::kLengthUnsaid:
        if (source_.program.language != gcode::Language::kSiemens) return;
        return text_.refuse(operation.where,
                            "moves along Z after a tool change without D, where the control's data "
                            "say whether the length of the tool counts");
      case OperationKind::kTool:
        return say_tool(operation, index);
      case OperationKind::kLength:
        return;  // said after its tool, or in the next motion
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
    if (operation.kind == OperationKind::kBlank && !source_.blank_is_remark) {
      return text_.refuse(operation.where,
                          "draws the blank for the simulation, which has no word there; --allow "
                          "blank-form leaves it as a comment");
    }
    if (!text_.add_comment_of(target_, operation.text, line_)) {
      text_.refuse(operation.where, "is no comment there");
    }
  }

  // Whether the target takes the word; an obstacle where it does not.
  bool takes(const Operation& operation, char letter, int tenths) {
    if (!refuses_word(target_, letter, tenths)) return true;
    text_.refuse(operation.where,
                 fmt::format("needs {}{}, which is not taken there", letter, tenths / 10));
    return false;
  }

  void say_work_offset(const Operation& operation) {
    const int code = operation.whole();
    if (siemens_ && code > 57) return text_.refuse(operation.where, "is another offset there");
    if (takes(operation, 'G', code * 10)) text_.add(fmt::format("G{}", code), line_);
  }

  void say_tool(const Operation& operation, std::size_t index) {
    if (!takes(operation, 'M', 60) || !takes(operation, 'T', operation.whole() * 10)) return;
    text_.add(fmt::format("T{} M6", operation.whole()), line_);
    // Said again: a tool change may have a program of its own.
    modal_.motion = MotionMode::kUnknown;
    modal_.feed.reset();
    say_length(operation, index);
  }

  // After the tool, since nothing moves along Z before its length counts; in the first motion
  // where that goes along Z, as controls want it that move to the length at once.
  void say_length(const Operation& tool, std::size_t index) {
    const auto begin = operations_.begin() + static_cast<std::ptrdiff_t>(index) + 1;
    const auto end =
        std::ranges::find(begin, operations_.end(), OperationKind::kTool, &Operation::kind);
    const auto next = [&](OperationKind kind) {
      return std::ranges::find(begin, end, kind, &Operation::kind);
    };
    if (next(OperationKind::kLength) == end) return;
    if (siemens_) return text_.add("D1", line_);
    if (!takes(tool, 'G', 430) || !takes(tool, 'H', tool.whole() * 10)) return;
    const std::string words = fmt::format("G43 H{}", tool.whole());
    const auto motion = next(OperationKind::kMotion);
    const bool along_z = motion != end && motion_of(*motion).axes_named[2] &&
                         motion_of(*motion).kind != gcode::MotionKind::kArc;
    if (!along_z) return text_.add(words, line_);
    before_next_ = words + " ";
  }

  // In the block of M3 or M4 where that comes next.
  void say_speed(const Operation& operation, std::size_t index) {
    if (!takes(operation, 'S', operation.whole() * 10)) return;
    const std::string speed = "S" + gcode::to_text(operation.number, kSpeedFormat);
    const bool turns = index + 1 < operations_.size() &&
                       operations_[index + 1].kind == OperationKind::kFunction &&
                       (operations_[index + 1].number == 3 || operations_[index + 1].number == 4);
    if (turns) {
      said_speed_ = speed + " ";
    } else {
      text_.add(speed, line_);
    }
  }

  void say_function(const Operation& operation) {
    if (!takes(operation, 'M', operation.whole() * 10)) return;
    text_.add(fmt::format("{}M{}", said_speed_, operation.whole()), line_);
    said_speed_.clear();
  }

  void say_dwell(const Operation& operation) {
    const std::string block = gcode::dwell_block(operation.whole(), target_.dwell_form);
    if (block.empty()) {
      return text_.refuse(operation.where,
                          fmt::format("waits for {} s, and how that is said there is not "
                                      "certain",
                                      gcode::dwell_seconds(operation.whole(), false)));
    }
    text_.add(block, line_);
  }

  void say_motion(const Operation& operation) {
    if (modal_.units != units_of(operation)) {
      say_units(operation);
      if (!siemens_) text_.add(unit_word_, line_);
    }
    const gcode::Motion& motion = motion_of(operation);
    const auto* arc = motion.piece.arc();
    std::string why =
        arc != nullptr ? say_arc(*arc, *operation.feed) : say_straight(motion, operation.feed);
    if (!why.empty()) text_.refuse(operation.where, std::move(why));
  }

  void say_end(const Operation& operation) {
    constexpr int kEnd = 30;
    const int code = operation.number == 0 ? kEnd : operation.whole();
    if (!takes(operation, 'M', code * 10)) return;
    if (operation.number == 0 && !text_.add_comment_of(target_, kEndRemark, line_)) {
      return text_.refuse(operation.where, "ends without M30, which needs a comment there");
    }
    text_.add(fmt::format("M{}", code), line_);
  }

  // --- motions: each function returns why the target cannot be told; else empty ---------------

  std::string say_straight(const gcode::Motion& motion, std::optional<double> feed) {
    gcode::SpokenBlock block;
    const geometry::Point3 end = motion.piece.end();
    for (int axis = 0; axis < 3; ++axis) {
      if (motion.axes_named[static_cast<std::size_t>(axis)]) print_place(end, axis, block);
    }
    const bool rapid = motion.kind == gcode::MotionKind::kRapid;
    return say_block(block, rapid ? MotionMode::kRapid : MotionMode::kLine, feed);
  }

  void print_place(const geometry::Point3& end, int axis, gcode::SpokenBlock& block) {
    std::string digits = digits_of(end[axis], axis);
    place_[axis] = gcode::read_number(digits)->value * unit_;
    block.places[static_cast<std::size_t>(axis)] = std::move(digits);
  }

  std::string say_block(gcode::SpokenBlock& block, MotionMode motion, std::optional<double> feed) {
    if (modal_.motion != motion || target_.repeats_words) block.motion = motion;
    modal_.motion = motion;
    if (feed && modal_.feed != feed) {
      block.feed = gcode::to_text(*feed / unit_, feed_format(target_));
      modal_.feed = feed;
    }
    std::string line;
    gcode::add_lines(block, target_.language, target_.blanks, "", line);
    return add_line(std::move(line));
  }

  std::string add_line(std::string line) {
    line.insert(0, std::exchange(before_next_, {}));
    if (line_length(target_, line) > target_.max_line_length) {
      return fmt::format("needs a line of more than {} characters", target_.max_line_length);
    }
    text_.add(line, line_);
    return {};
  }

  // In as many parts as the target needs: its arcs may be short, and full turns none.
  std::string say_arc(const geometry::Arc& arc, double feed) {
    if (rises(arc) && !target_.helices) return "is a helix";
    const gcode::PlaneAxes* plane = gcode::plane_across(arc.axis);
    if (plane == nullptr || !takes_arcs_in(target_, plane->plane))
      return "is an arc in another plane";
    constexpr double kSlack = 1e-9;  // of a part: none more for the rounding of a half turn
    const int least = std::max(
        1, static_cast<int>(std::ceil(std::abs(arc.sweep) / max_arc_sweep(target_) - kSlack)));
    for (const int parts : {least, least + 1, 2 * (least + 1)}) {
      if (const auto lines = arc_in_parts(arc, *plane, feed, parts)) return add_lines(*lines);
    }
    constexpr int kMostChords = 100;
    const double step = gcode::printed_step(place_format(target_, modal_.units), modal_.units);
    for (int chords = 1; chords <= kMostChords; ++chords) {
      const double sagitta = sagitta_of(arc, chords);
      if (sagitta > step) continue;
      text_.add_rounding(sagitta);
      return say_chords(arc, *plane, feed, chords);
    }
    const std::string_view why = gcode::arc_refusal(target_, arc, modal_.units);
    return why.empty() ? "is an arc that rounding would change"
                       : fmt::format("is an arc that is not taken there: {}", why);
  }

  // The blocks, where the target takes all parts; only then this knows that they were said.
  std::optional<std::string> arc_in_parts(const geometry::Arc& arc, const gcode::PlaneAxes& plane,
                                          double feed, int parts) {
    gcode::Position start{place_, {true, true, true}};
    const bool level = !rises(arc);
    if (level) start.mm[plane.normal] = arc.start[plane.normal];
    gcode::Writer writer(target_, {modal_, start}, "\n");
    for (int i = 0; i < parts; ++i) {
      const auto part =
          geometry::sub_piece(geometry::PathPiece(arc), static_cast<double>(i) / parts,
                              static_cast<double>(i + 1) / parts);
      if (!writer.arc_to(std::get<geometry::Arc>(part), feed)) return std::nullopt;
    }
    modal_ = writer.state().modal;
    modal_.feed = feed;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == plane.normal && level) continue;
      (void)digits_of(arc.end[axis], axis);  // whose rounding counts
      place_[axis] = writer.state().position.mm[axis];
    }
    return writer.text();
  }

  std::string digits_of(double mm, int axis) {
    return text_.place(mm, axis, place_format(target_, modal_.units), unit_);
  }

  std::string add_lines(std::string_view lines) {
    while (!lines.empty()) {
      const std::size_t end = lines.find('\n');
      if (std::string why = add_line(std::string(lines.substr(0, end))); !why.empty()) return why;
      lines.remove_prefix(end + 1);
    }
    return {};
  }

  std::string say_chords(const geometry::Arc& arc, const gcode::PlaneAxes& plane, double feed,
                         int chords) {
    for (int i = 1; i <= chords; ++i) {
      gcode::SpokenBlock block;
      const geometry::Point3 end =
          geometry::point_at(geometry::PathPiece(arc), static_cast<double>(i) / chords);
      for (int axis = 0; axis < 3; ++axis) {
        if (axis != plane.normal || rises(arc)) print_place(end, axis, block);
      }
      if (std::string why = say_block(block, MotionMode::kLine, feed); !why.empty()) return why;
    }
    return {};
  }

  const TranslationSource& source_;
  const std::vector<Operation>& operations_;
  const gcode::Control& target_;
  bool siemens_;
  std::string name_;
  TranslationText text_;
  std::uint32_t line_ = 1;
  std::string said_speed_;   // for the M3 or M4 that comes next
  std::string before_next_;  // words that go before those of the next motion, in its block
  std::string_view unit_word_;
  gcode::ModalState modal_;                            // as the control has it
  geometry::Point3 place_ = geometry::Point3::Zero();  // as printed, mm; 0 where not known
  double unit_ = 1;                                    // mm
};

}  // namespace

Translation in_plain_words(const TranslationSource& source, const gcode::Control& target,
                           std::string_view name) {
  return PlainSpeaker(source, target, name).say();
}

}  // namespace batten::postproc
