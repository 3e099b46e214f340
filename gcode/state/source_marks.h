// Words by which a program tells for which controls it was made, where others refuse them or take
// them for something else.
#pragma once

#include <cstdint>
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

}  // namespace batten::gcode
