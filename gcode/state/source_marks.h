// Words by which a program tells for which controls it was made, where others refuse them or take
// them for something else.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/text/program.h"

namespace batten::gcode {

enum class SourceMark : std::uint8_t {
  kSubWords,         // O100 sub, o<name> call, endsub: LinuxCNC and its kin
  kNamedParameters,  // #<depth>
  kBlendTolerance,   // G64 P.. Q..
  kUniformNurbs,     // G5.2, G5.3
  kMacroFlow,        // IF [..] GOTO 10, WHILE [..] DO 1: FANUC's macro B
  kHighSpeedMode,    // G5.1 Q.., G5 P10000
  kHaasSmoothness,   // G187
  kSuperNurbs,       // G131, G130
  kHeaterWords,      // M104 S.., M109 S.., M140 S.., M190 S..: 3D printers
  kDollarLine,       // $..: grbl's settings
  kHashCommand,      // #HSC ON, #SPLINE ..: ISG and Fagor
};

// A set of marks, one bit each.
using SourceMarks = std::uint32_t;
[[nodiscard]] constexpr SourceMarks mark(SourceMark one) {
  return SourceMarks{1} << static_cast<unsigned>(one);
}
inline constexpr SourceMarks kAllMarks = ~SourceMarks{0};

// In words, with the controls that it belongs to.
[[nodiscard]] std::string_view describe(SourceMark mark);

struct FoundMark {
  SourceMark mark = SourceMark::kSubWords;
  SourceSpan where;
};

// The first place of each mark, in the order of the program.
[[nodiscard]] std::vector<FoundMark> source_marks(const Program& program);

// Marks by which a program for a lathe is known. There X may be a diameter, U and W are increments,
// and G90, G92, G94 may be cycles: read as a mill's program, its cuts would not be where they seem.

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
