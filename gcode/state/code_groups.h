// Modal groups: which codes exclude each other in a block.
#pragma once

#include <cstdint>

namespace batten::gcode {

// A G or M code in tenths: G38.2 is 382, G1 is 10, M3 is 30.
using Code = int;

enum class CodeGroup : std::uint8_t {
  kUnknown,      // a code that is not known: it could change anything
  kNone,         // acts in its own block only; does not exclude others
  kAxisUser,     // acts in its own block only, on the axis words: G28, G92, G10 ..
  kMotion,       // G0 G1 G2 G3, threading, cycles, splines, probing
  kCycleEnd,     // G80: a motion word beside it wins
  kPlane,        // G17 G18 G19
  kDistance,     // G90 G91
  kArcDistance,  // G90.1 G91.1
  kFeedMode,     // G93 G94 G95
  kUnits,        // G20 G21
  kCutter,       // G40 G41 G42
  kToolLength,   // G43 G49
  kCycleReturn,  // G98 G99
  kWorkOffset,   // G54 ..
  kPath,         // G61 G61.1 G64
  kSpindleMode,  // G96 G97
  kDiameter,     // G7 G8
  kScaling,      // G50 G51
  kRotation,     // G68 G69
  kMirror,       // G50.1 G51.1
  kPolar,        // G15 G16, G12.1 G13.1
  kCylindrical,  // G7.1
  kSmoothing,    // G5.1 Q.., G5 P.., G131
  kModalMacro,   // G66 G67
};

// The group of a G code. G5, G5.1, G8, G50, G70, G71 and G92 mean different things to different
// controls; their group is that of the meaning that needs most care.
[[nodiscard]] CodeGroup group_of_g(Code code);

// True for M words of which a block can hold only one: the stops, and the spindle words.
[[nodiscard]] bool excludes_m(Code a, Code b);

}  // namespace batten::gcode
