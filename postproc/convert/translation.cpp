#include "postproc/convert/translation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gcode/control/block_spelling.h"
#include "gcode/curves/heidenhain_spl.h"
#include "gcode/state/dwell.h"
#include "gcode/text/characters.h"

namespace batten::postproc {
namespace {

// Letters of other alphabets are not the same bytes on all controls.
char plain(char c) { return c >= ' ' && c <= '~' ? c : c == '\t' ? ' ' : '?'; }

bool is_plain_in_comments(char c) {
  return gcode::is_letter(c) || gcode::is_digit(c) || std::string_view(" .,:+-=").find(c) < 7;
}

// As it is, or without what this target does not take there.
std::string comment_said(const gcode::Control& target, std::string_view text) {
  std::string line = comment_line(target, text);
  if (!line.empty()) return line;
  std::string mild(text);
  std::ranges::replace_if(
      mild, [](char c) { return !is_plain_in_comments(c); }, '-');
  line = comment_line(target, mild);
  // "MSG, .." acts on some controls.
  return line.empty() ? comment_line(target, "- " + mild) : line;
}

using gcode::MotionKind;

// 5 digits before the point, 4 after it (docs/controllers/heidenhain.md).
constexpr double kFarthest = 99999.9999;

class KlartextSpeaker {
 public:
  KlartextSpeaker(const TranslationSource& source, const gcode::Control& target,
                  std::string_view name)
      : source_(source),
        places_(place_format(target, gcode::Units::kMillimetre)),
        centers_(center_format(target, gcode::Units::kMillimetre)),
        feeds_(feed_format(target)),
        longest_(target.max_line_length),
        name_(name) {}

  Translation say() {
    text_.add(fmt::format("BEGIN PGM {} MM", name_), 1);
    const auto& operations = source_.operations.operations;
    for (std::size_t i = 0; i < operations.size(); ++i) {
      line_ = source_.program.blocks[operations[i].block].line;
      std::size_t next = i + 1;
      while (next < operations.size() && operations[next].kind == OperationKind::kLength) ++next;
      say_operation(operations[i], next < operations.size() ? &operations[next] : nullptr);
    }
    text_.add(fmt::format("END PGM {} MM", name_), line_);
    return text_.take();
  }

 private:
  void say_operation(const Operation& operation, const Operation* next) {
    switch (operation.kind) {
      case OperationKind::kComment:
      case OperationKind::kBlank:
        return text_.add_comment(operation.text, line_, longest_);
      case OperationKind::kBlending:
      case OperationKind::kLength:
        return;  // always so there
      case OperationKind::kWorkOffset:
        return say_work_offset(operation);
      case OperationKind::kNoLength:
        return say_no_length(operation, kLengthRemark, "without the length of the tool, which");
      case OperationKind::kLengthUnsaid:
        return say_no_length(operation, kUnsaidLengthRemark,
                             "along Z after a tool change without G43 or D, and the length");
      case OperationKind::kTool: {
        speed_is_said_ = next != nullptr && next->kind == OperationKind::kSpeed;
        const std::string speed =
            speed_is_said_ ? fmt::format(" S{}", gcode::to_text(next->number, feeds_)) : "";
        return call_tool(fmt::format("TOOL CALL {} Z{}", operation.whole(), speed));
      }
      case OperationKind::kSpeed:
        if (std::exchange(speed_is_said_, false)) return;
        return call_tool(fmt::format("TOOL CALL Z S{}", gcode::to_text(operation.number, feeds_)));
      case OperationKind::kDwell:
        text_.add("CYCL DEF 9.0 DWELL TIME", line_);
        return text_.add(
            fmt::format("CYCL DEF 9.1 DWELL {}", gcode::dwell_seconds(operation.whole(), false)),
            line_);
      case OperationKind::kFunction:
      case OperationKind::kEnd:
        return text_.add(fmt::format("M{}", operation.whole()), line_);
      case OperationKind::kMotion:
        return say_motion(operation);
    }
  }

  // The feed may be set there, too, and is said again.
  void call_tool(const std::string& line) {
    said_feed_.reset();
    text_.add(line, line_);
  }

  void say_work_offset(const Operation& operation) {
    if (!source_.datum_is_work_offset) {
      return text_.refuse(operation.where,
                          "names a work offset, and there the datum is set at the control; --allow "
                          "work-offset takes the one that is active then");
    }
    text_.add_comment(datum_remark(operation.whole()), line_, longest_);
  }

  void say_no_length(const Operation& operation, std::string_view remark, std::string_view how) {
    if (!source_.length_counts_always) {
      return text_.refuse(operation.where, fmt::format("moves {} always counts there; --allow "
                                                       "tool-length takes it all the same",
                                                       how));
    }
    text_.add_comment(remark, line_, longest_);
  }

  // --- motions ------------------------------------------------------------------------------

  void say_motion(const Operation& operation) {
    const gcode::Motion& motion =
        source_.meaning.motions[static_cast<std::size_t>(operation.motion)];
    if (const auto* arc = motion.piece.arc()) return say_arc(operation, *arc);
    gcode::SpokenBlock block;
    const geometry::Point3 end = motion.piece.end();
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      if (motion.axes_named[i]) block.places[i] = place(operation, end[axis], axis);
    }
    const bool rapid = motion.kind == MotionKind::kRapid;
    std::string line;
    add_lines(block, gcode::Language::kKlartext, true, "", line);
    // Off is what the control begins with; said once, as posts do.
    if (!std::exchange(compensation_is_said_, true)) line += " R0";
    const std::string feed = rapid ? "MAX" : feed_of(operation);
    if (!feed.empty()) line += " F" + feed;
    text_.add(line, line_);
  }

  void say_arc(const Operation& operation, const geometry::Arc& arc) {
    if (std::abs(arc.axis.z()) < 1)
      return text_.refuse(operation.where, "is an arc in another plane");
    if (rises(arc)) return text_.refuse(operation.where, "is a helix");
    const double at_start = (arc.start - arc.center).head<2>().norm();
    const double at_end = (arc.end - arc.center).head<2>().norm();
    if (std::abs(at_start - at_end) > gcode::kKlartextRadiusMismatch) {
      return text_.refuse(operation.where, "is an arc whose radii differ");
    }
    gcode::SpokenBlock block;
    const bool clockwise = (arc.axis.z() > 0) == (arc.sweep < 0);
    block.motion = clockwise ? gcode::MotionMode::kClockwise : gcode::MotionMode::kCounterclockwise;
    for (int axis = 0; axis < 2; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      block.places[i] = place(operation, arc.end[axis], axis);
      block.centers[i] = gcode::to_text(arc.center[axis], centers_);
    }
    block.feed = feed_of(operation);
    std::string lines;
    add_lines(block, gcode::Language::kKlartext, true, "\n", lines);
    const std::size_t first = lines.find('\n');
    text_.add(std::string_view(lines).substr(0, first), line_);
    text_.add(std::string_view(lines).substr(first + 1, lines.size() - first - 2), line_);
  }

  std::string place(const Operation& operation, double mm, int axis) {
    if (std::abs(mm) > kFarthest)
      text_.refuse(operation.where, "goes beyond the range of the control");
    return text_.place(mm, axis, places_);
  }

  std::string feed_of(const Operation& operation) {
    if (said_feed_ == operation.feed) return {};
    said_feed_ = operation.feed;
    return gcode::to_text(*operation.feed, feeds_);
  }

  const TranslationSource& source_;
  gcode::NumberFormat places_;
  gcode::NumberFormat centers_;
  gcode::NumberFormat feeds_;
  std::size_t longest_;
  std::string name_;
  TranslationText text_;
  std::uint32_t line_ = 1;
  std::optional<double> said_feed_;
  bool speed_is_said_ = false;  // in the block of the tool
  bool compensation_is_said_ = false;
};

}  // namespace

void TranslationText::add_comment(std::string_view text, std::uint32_t source_line,
                                  std::size_t longest) {
  constexpr std::string_view kBegin = "; ";
  std::string rest;
  std::ranges::transform(text, std::back_inserter(rest), plain);
  // A ~ at the end of a line of Klartext goes on in the next one.
  std::ranges::replace(rest, '~', '-');
  const std::size_t room = longest - kBegin.size();
  do {
    const std::string part = rest.substr(0, room);
    add(std::string(kBegin) + part, source_line);
    rest.erase(0, part.size());
  } while (!rest.empty());
}

bool TranslationText::add_comment_of(const gcode::Control& target, std::string_view text,
                                     std::uint32_t source_line) {
  constexpr std::size_t kBrackets = 2;
  const std::size_t room = target.max_line_length - kBrackets;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, room);
    const std::string line = comment_said(target, part);
    if (line.empty()) return false;
    add(line, source_line);
    text.remove_prefix(part.size());
  }
  return true;
}

std::string TranslationText::place(double mm, int axis, const gcode::NumberFormat& format,
                                   double unit) {
  const double error = std::abs(gcode::rounded(mm / unit, format.decimals) * unit - mm);
  // Sums of decimals are off by less than this, which is no rounding of ours.
  constexpr double kNoise = 1e-9;
  if (error > kNoise) rounding_[axis] = std::max(rounding_[axis], error);
  return gcode::to_text(mm / unit, format);
}

Translation TranslationText::take() {
  result_.rounding_mm = rounding_.norm() + beside_;
  return std::move(result_);
}

std::string program_name(std::string_view file) {
  constexpr std::size_t kLongest = 16;
  file.remove_prefix(file.find_last_of("/\\") + 1);  // npos + 1 is 0
  file = file.substr(0, file.find('.'));
  std::string name;
  for (const char c : file.substr(0, kLongest)) {
    name += gcode::is_letter(c) || gcode::is_digit(c) ? gcode::upper(c) : '_';
  }
  return name.empty() || name == "_" ? "PROGRAM" : name;
}

Translation in_klartext(const TranslationSource& source, const gcode::Control& target,
                        std::string_view name) {
  return KlartextSpeaker(source, target, name).say();
}

}  // namespace batten::postproc
