#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "gcode/control/block_spelling.h"
#include "gcode/controls/arc_rules.h"
#include "gcode/state/dwell.h"
#include "gcode/writer/writer.h"
#include "postproc/convert/klartext_statements.h"
#include "postproc/convert/translation.h"

namespace batten::postproc {
namespace {

using gcode::MotionMode;

constexpr gcode::NumberFormat kSpeedFormat = {.decimals = 3};

// mm: an arc that rises by more is a helix.
constexpr double kNoRise = 1e-9;

// mm: how far the arc leaves so many chords of equal length.
double sagitta_of(const geometry::Arc& arc, int chords) {
  const geometry::Vector3 from_center = arc.start - arc.center;
  const double radius = (from_center - from_center.dot(arc.axis) * arc.axis).norm();
  const double half = std::abs(arc.sweep) / 2 / chords;
  return radius * (1 - std::cos(std::min(half, std::numbers::pi)));
}

// Motions as blocks of plain words.
class PlainMoves {
 public:
  // Blocks go to `text`, which must outlive it.
  PlainMoves(const gcode::Control& target, TranslationText& text) : target_(target), text_(text) {
    modal_.units = gcode::Units::kMillimetre;
  }

  // From here on places are in these units. Says nothing.
  void use_units(gcode::Units units) {
    modal_.units = units == gcode::Units::kInch ? units : gcode::Units::kMillimetre;
    unit_ = gcode::millimetres_per(modal_.units);
    modal_.feed.reset();
  }
  [[nodiscard]] gcode::Units units() const { return modal_.units; }

  // G21, G20; or the target's own words for them.
  std::string_view unit_word() const { return gcode::unit_word(target_, modal_.units); }

  // What the target takes its unit word for instead; empty where it is its own.
  std::string_view other_meaning_of_units() const {
    const std::string_view word = unit_word();
    if (word == "G20") return other_meaning(target_, 200);
    return word == "G21" ? other_meaning(target_, 210) : "";
  }

  // Motion word and feed are said again: a tool change may have a program of its own.
  void forget_modes() {
    modal_.motion = MotionMode::kUnknown;
    modal_.feed.reset();
  }

  // Words that stand before those of the next motion, in its block.
  void say_before_next(std::string words) { before_next_ = std::move(words) + " "; }

  // The axes that the motion names, all that is known of it at `feed` (mm/min). Returns why the
  // target cannot be told; else empty.
  std::string say(const gcode::Motion& motion, std::optional<double> feed,
                  std::uint32_t source_line) {
    source_line_ = source_line;
    const auto* arc = motion.piece.arc();
    return arc != nullptr ? say_arc(*arc, *feed) : say_straight(motion, feed);
  }

 private:
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
    std::string digits = text_.place(end[axis], axis, place_format(target_, modal_.units), unit_);
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
    text_.add(line, source_line_);
    return {};
  }

  // In as many parts as the target needs: its arcs may be short, and full turns none.
  std::string say_arc(const geometry::Arc& arc, double feed) {
    if (std::abs(arc.axis.dot(arc.end - arc.start)) > kNoRise && !target_.helices) {
      return "is a helix";
    }
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
    for (int chords = 1; chords <= kMostChords; ++chords) {
      const double sagitta = sagitta_of(arc, chords);
      if (sagitta > printed_step()) continue;
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
    const bool level = std::abs(arc.axis.dot(arc.end - arc.start)) <= kNoRise;
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
      note_rounding(arc.end[axis], axis);
      place_[axis] = writer.state().position.mm[axis];
    }
    return writer.text();
  }

  void note_rounding(double mm, int axis) {
    (void)text_.place(mm, axis, place_format(target_, modal_.units), unit_);
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
    const bool rises = std::abs(arc.axis.dot(arc.end - arc.start)) > kNoRise;
    for (int i = 1; i <= chords; ++i) {
      gcode::SpokenBlock block;
      const geometry::Point3 end =
          geometry::point_at(geometry::PathPiece(arc), static_cast<double>(i) / chords);
      for (int axis = 0; axis < 3; ++axis) {
        if (axis != plane.normal || rises) print_place(end, axis, block);
      }
      if (std::string why = say_block(block, MotionMode::kLine, feed); !why.empty()) return why;
    }
    return {};
  }

  double printed_step() const {
    return gcode::printed_step(place_format(target_, modal_.units), modal_.units);
  }

  const gcode::Control& target_;
  TranslationText& text_;
  std::uint32_t source_line_ = 1;
  gcode::ModalState modal_;                            // as the control has it
  geometry::Point3 place_ = geometry::Point3::Zero();  // as printed, mm; 0 where not known
  double unit_ = 1;                                    // mm
  std::string before_next_;
};

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
    return (target_.known_marks & kOfFanuc) != 0;
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
                 "moves along Z after a tool change without D, where the control's data say "
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
