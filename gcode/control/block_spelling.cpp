#include "gcode/control/block_spelling.h"

namespace batten::gcode {
namespace {

// Words one behind the other, at the end of a text.
class WordLine {
 public:
  WordLine(bool blanks, std::string& text) : blanks_(blanks), text_(text) {}

  void add(std::string_view name, std::string_view value) {
    if (!first_ && blanks_) text_ += ' ';
    text_ += name;
    text_ += value;
    first_ = false;
  }
  void add(char letter, std::string_view digits) { add(std::string_view(&letter, 1), digits); }

  // Those of three axes, from this letter on, that are said.
  void add_axes(char first, const std::array<std::string, 3>& digits) {
    for (const std::string& each : digits) {
      if (!each.empty()) add(first, each);
      ++first;
    }
  }

  void add_signed(char letter, const std::string& digits) {
    add(letter, digits.starts_with('-') ? digits : "+" + digits);
  }

 private:
  bool blanks_;
  bool first_ = true;
  std::string& text_;
};

// G1 X1 Y2 F500
void add_rs274(const SpokenBlock& block, bool blanks, std::string& text) {
  WordLine line(blanks, text);
  if (block.plane) {
    line.add('G', *block.plane == Plane::kXY ? "17" : *block.plane == Plane::kZX ? "18" : "19");
  }
  if (block.motion) {
    const int code = static_cast<int>(*block.motion) - static_cast<int>(MotionMode::kRapid);
    line.add('G', std::to_string(code));
  }
  line.add_axes('X', block.places);
  line.add_axes('I', block.centers);
  if (!block.radius.empty()) line.add('R', block.radius);
  if (!block.feed.empty()) line.add('F', block.feed);
}

// L X+1 Y+2 F500; CC X+0 Y+0 and C X+1 Y+2 DR+ for arcs. Block numbers are added where the place in
// the program is known.
void add_klartext(const SpokenBlock& block, std::string_view line_end, std::string& text) {
  const bool clockwise = block.motion == MotionMode::kClockwise;
  const bool arc = clockwise || block.motion == MotionMode::kCounterclockwise;
  const bool by_radius = arc && !block.radius.empty();
  if (arc && !by_radius) {
    WordLine center(true, text);
    center.add("CC", {});
    center.add_signed('X', block.centers[0]);
    center.add_signed('Y', block.centers[1]);
    text += line_end;
  }
  WordLine line(true, text);
  line.add(by_radius ? "CR" : arc ? "C" : "L", {});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto letter = static_cast<char>('X' + axis);
    if (!block.places[axis].empty()) line.add_signed(letter, block.places[axis]);
  }
  if (by_radius) line.add_signed('R', block.radius);
  if (arc) line.add(clockwise ? "DR-" : "DR+", {});
  if (!block.feed.empty()) line.add('F', block.feed);
}

}  // namespace

void add_lines(const SpokenBlock& block, Language language, bool blanks, std::string_view line_end,
               std::string& text) {
  if (language == Language::kKlartext) {
    add_klartext(block, line_end, text);
  } else {
    add_rs274(block, blanks, text);
  }
  text += line_end;
}

}  // namespace batten::gcode
