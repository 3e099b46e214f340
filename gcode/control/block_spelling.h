// How the words of a block are spelt: one class for each language that is written.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/state/modal_state.h"

namespace batten::gcode {

// What one block is to say. Empty and nothing: not said.
struct SpokenBlock {
  std::optional<Plane> plane;
  std::optional<MotionMode> motion;    // G0 to G3
  std::array<std::string, 3> places;   // X Y Z
  std::array<std::string, 3> centers;  // I J K
  std::string radius;                  // R
  std::string feed;

  void clear();  // says nothing any more; its texts keep their room

  [[nodiscard]] bool is_empty() const;
  // F stands alone.
  [[nodiscard]] bool says_only_feed() const;

 private:
  [[nodiscard]] bool has_no_numbers() const;
};

class BlockSpelling {
 public:
  virtual ~BlockSpelling() = default;

  // Whether a motion word stays in force: blocks behind it may leave it out, and need not find
  // another one.
  [[nodiscard]] virtual bool motion_stays() const = 0;

  // Whether centres of arcs are places, whatever the state says.
  [[nodiscard]] virtual bool centers_are_places() const = 0;

  // The block, or the blocks that say it, each with this line end, at the end of `text`.
  virtual void add_lines(const SpokenBlock& block, bool blanks, std::string_view line_end,
                         std::string& text) const = 0;

  // The same by itself.
  [[nodiscard]] std::string lines(const SpokenBlock& block, bool blanks,
                                  std::string_view line_end) const;
};

// G1 X1 Y2 F500
[[nodiscard]] const BlockSpelling& rs274_spelling();

// L X+1 Y+2 F500; CC X+0 Y+0 and C X+1 Y+2 DR+ for arcs. Numbers have a sign, block numbers are
// added where the place in the program is known.
[[nodiscard]] const BlockSpelling& klartext_spelling();

}  // namespace batten::gcode
