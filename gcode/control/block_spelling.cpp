#include "gcode/control/block_spelling.h"

#include <algorithm>

namespace batten::gcode {
namespace {

constexpr std::array<char, 3> kPlaceLetters = {'X', 'Y', 'Z'};
constexpr std::array<char, 3> kOffsetLetters = {'I', 'J', 'K'};

bool is_empty_text(const std::string& text) { return text.empty(); }

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

  void add_signed(char letter, const std::string& digits) {
    add(letter, digits.starts_with('-') ? digits : "+" + digits);
  }

 private:
  bool blanks_;
  bool first_ = true;
  std::string& text_;
};

std::string_view number_of(MotionMode motion) {
  constexpr std::array<std::string_view, 4> kNumbers = {"0", "1", "2", "3"};
  return kNumbers[static_cast<std::size_t>(motion) - static_cast<std::size_t>(MotionMode::kRapid)];
}

// G1 X1 Y2 F500
void add_rs274(const SpokenBlock& block, bool blanks, std::string& text) {
  WordLine line(blanks, text);
  if (block.plane) {
    line.add('G', *block.plane == Plane::kXY ? "17" : *block.plane == Plane::kZX ? "18" : "19");
  }
  if (block.motion) line.add('G', number_of(*block.motion));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!block.places[axis].empty()) line.add(kPlaceLetters[axis], block.places[axis]);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!block.centers[axis].empty()) line.add(kOffsetLetters[axis], block.centers[axis]);
  }
  if (!block.radius.empty()) line.add('R', block.radius);
  if (!block.feed.empty()) line.add('F', block.feed);
}

// In the plane of X and Y.
void add_klartext_center(const SpokenBlock& block, std::string& text) {
  WordLine line(true, text);
  line.add("CC", {});
  for (std::size_t axis = 0; axis < 2; ++axis) {
    line.add_signed(kPlaceLetters[axis], block.centers[axis]);
  }
}

// L X+1 Y+2 F500; CC X+0 Y+0 and C X+1 Y+2 DR+ for arcs. Block numbers are added where the place in
// the program is known.
void add_klartext(const SpokenBlock& block, std::string_view line_end, std::string& text) {
  const bool clockwise = block.motion == MotionMode::kClockwise;
  const bool arc = clockwise || block.motion == MotionMode::kCounterclockwise;
  const bool by_radius = arc && !block.radius.empty();
  if (arc && !by_radius) {
    add_klartext_center(block, text);
    text += line_end;
  }
  WordLine line(true, text);
  line.add(by_radius ? "CR" : arc ? "C" : "L", {});
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!block.places[axis].empty()) line.add_signed(kPlaceLetters[axis], block.places[axis]);
  }
  if (by_radius) line.add_signed('R', block.radius);
  if (arc) line.add(clockwise ? "DR-" : "DR+", {});
  if (!block.feed.empty()) line.add('F', block.feed);
}

}  // namespace

void SpokenBlock::clear() {
  plane.reset();
  motion.reset();
  for (std::string& place : places) place.clear();
  for (std::string& center : centers) center.clear();
  radius.clear();
  feed.clear();
}

bool SpokenBlock::is_empty() const { return !plane && !motion && feed.empty() && has_no_numbers(); }

bool SpokenBlock::says_only_feed() const {
  return !plane && !motion && !feed.empty() && has_no_numbers();
}

bool SpokenBlock::has_no_numbers() const {
  return radius.empty() && std::ranges::all_of(places, is_empty_text) &&
         std::ranges::all_of(centers, is_empty_text);
}

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
