// Marks by which a program for a lathe is known. There X may be a diameter, U and W are increments,
// and G90, G92, G94 may be cycles: read as a mill's program, its cuts would not be where they seem.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "gcode/text/program.h"

namespace batten::gcode {

// Of what kind a mark is that a mill's program may have, too. `kCertain`: none has it.
enum class LatheMarkKind : std::uint8_t {
  kCertain,
  kTool,       // T0101: a tool and its offset
  kSpindle,    // constant surface speed, a limit of the spindle
  kFeed,       // per revolution
  kCycle,      // words of a turning cycle that are others on a mill
  kIncrement,  // U or W beside Z or X
};
inline constexpr std::size_t kLatheMarkKinds = 6;

struct LatheMark {
  LatheMarkKind kind = LatheMarkKind::kCertain;
  std::string_view text;  // what it is, with the controls that have it
};

// A program is one for a lathe with a certain mark, or with marks of two other kinds where no block
// names Y: a mill's program names Y, but for one in X and Z alone.
class LatheWatch {
 public:
  // A part of the program, from its begin; the whole may be one.
  void see(const Program& part);

  // The whole was seen and is none: parts that are read again say nothing. Requires !is_lathe().
  void settle() {
    found_ = {};
    settled_ = true;
  }

  // Of the parts that were seen: a certain mark stays, others are none when Y is named later.
  [[nodiscard]] bool is_lathe() const;

  // Where the program is known to be one, and by what. Requires is_lathe().
  [[nodiscard]] SourceSpan where() const;
  [[nodiscard]] std::string evidence() const;

 private:
  struct Found {
    LatheMark mark;
    SourceSpan where;
    std::uint32_t line = 0;
  };

  void note(const LatheMark& mark, SourceSpan where, std::uint32_t line);
  void look_at_words(const Program& part, const Block& block);
  void look_at_text(const Program& part, const Block& block);
  // The first two in the text.
  [[nodiscard]] std::array<const Found*, 2> first_two() const;

  std::array<std::optional<Found>, kLatheMarkKinds> found_;  // the first of each kind
  bool settled_ = false;
  bool names_y_ = false;
  bool in_inches_ = false;
  bool feed_is_a_speed_ = true;  // not G93: F0.5 is two minutes there
};

}  // namespace batten::gcode
