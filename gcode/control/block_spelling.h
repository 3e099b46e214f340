// How the words of a block are spelt in each language that is written.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/state/modal_state.h"
#include "gcode/text/language.h"

namespace batten::gcode {

// What one block is to say. Empty and nothing: not said.
struct SpokenBlock {
  std::optional<Plane> plane;
  std::optional<MotionMode> motion;    // G0 to G3
  std::array<std::string, 3> places;   // X Y Z
  std::array<std::string, 3> centers;  // I J K
  std::string radius;                  // R
  std::string feed;
  bool operator==(const SpokenBlock&) const = default;
};

// Whether a motion word stays in force: blocks behind it may leave it out, and need not find
// another one.
[[nodiscard]] constexpr bool motion_stays(Language language) {
  return language != Language::kKlartext;
}

// Whether centres of arcs are places, whatever the state says.
[[nodiscard]] constexpr bool centers_are_places(Language language) {
  return language == Language::kKlartext;
}

// The block, or the blocks that say it, each with this line end, at the end of `text`. `blanks`:
// between words; Klartext has them always.
void add_lines(const SpokenBlock& block, Language language, bool blanks, std::string_view line_end,
               std::string& text);

}  // namespace batten::gcode
