// The one table of G and M codes of the RS-274 family: which exclude each other, what each sets,
// why it ends a run, and what it means for the proof, for the time of a program and for --convert.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "gcode/text/program.h"

namespace batten::gcode {

// A G or M code in tenths: G38.2 is 382, G1 is 10, M3 is 30.
using Code = int;
inline constexpr Code kNoCode = -1;

// The code of a G or M word; kNoCode where its number is none of at most one decimal.
[[nodiscard]] Code code_of(const Word& word);

enum class Units : std::uint8_t { kUnknown, kMillimetre, kInch };
inline constexpr double kMillimetresPerInch = 25.4;
enum class Plane : std::uint8_t { kUnknown, kXY, kZX, kYZ };  // G17, G18, G19
enum class DistanceMode : std::uint8_t { kUnknown, kAbsolute, kIncremental };
enum class FeedMode : std::uint8_t { kUnknown, kPerMinute, kInverseTime, kPerRevolution };
enum class PathMode : std::uint8_t {
  kUnknown,
  kBlending,   // G64, or the control's default
  kExactPath,  // G61
  kExactStop,  // G61.1, G60
};
enum class MotionMode : std::uint8_t {
  kUnknown,
  kRapid,             // G0
  kLine,              // G1
  kClockwise,         // G2
  kCounterclockwise,  // G3
  kOther,             // threading, probing, canned cycles, splines, G80: axis words are no line
};

[[nodiscard]] constexpr bool is_arc(MotionMode mode) {
  return mode == MotionMode::kClockwise || mode == MotionMode::kCounterclockwise;
}

// On, off, or unknown.
enum class TriState : std::uint8_t { kOff, kOn, kUnknown };

// Codes of one group exclude each other in a block, but for kUnknown and kNone.
enum class CodeGroup : std::uint8_t {
  kUnknown,             // a G code that is not known: it could change anything
  kNone,                // acts in its own block only; does not exclude others
  kAxisUser,            // acts in its own block only, on the axis words: G28, G92, G10 ..
  kMotion,              // G0 G1 G2 G3, threading, cycles, splines, probing
  kCycleEnd,            // G80: a motion word beside it wins
  kPlane,               // G17 G18 G19
  kDistance,            // G90 G91
  kArcDistance,         // G90.1 G91.1
  kFeedMode,            // G93 G94 G95
  kUnits,               // G20 G21
  kCutter,              // G40 G41 G42
  kToolLength,          // G43 G49
  kCycleReturn,         // G98 G99
  kWorkOffset,          // G54 ..
  kPath,                // G61 G61.1 G64
  kSpindleMode,         // G96 G97
  kDiameter,            // G7 G8
  kScaling,             // G50 G51
  kRotation,            // G68 G69
  kMirror,              // G50.1 G51.1
  kPolar,               // G15 G16
  kPolarInterpolation,  // G12.1 G13.1
  kCylindrical,         // G7.1
  kSmoothing,           // G5.1 Q.., G5 P.., G131
  kModalMacro,          // G66 G67
  kStop,                // M0 M1 M2 M30 M60
  kTurning,             // M3 M4 M5
};
inline constexpr std::size_t kCodeGroups = static_cast<std::size_t>(CodeGroup::kTurning) + 1;

// What a code does, where its group does not say it.
enum class CodeAct : std::uint8_t {
  kNothing,
  kDwell,         // G4
  kMachinePlace,  // G53: a motion to a place that is not known in the program's coordinates
  kHome,          // G28, G30: the same, by an intermediate place
  kStoresHome,    // G28.1, G30.1
  kSetsPlace,     // G92
  kWritesData,    // G10
  kMovesOrigin,   // G52 ..
  kDrills,        // a cycle along one axis
  kCalls,         // G65, M98, and M99, which goes back
  kSpindleOn,
  kChangesTool,   // M6
  kSwitches,      // spindle off, coolant ..: the motion ends before it
  kStops,         // until the operator goes on
  kEnds,          // the program
  kOverride,      // M48, M49: nothing that takes time
  kMirrors,       // M21 ..
  kTurnsToolTip,  // M128, M129
  kBuilders,      // another M code
};

// More that is to be known of a code; a row has some of them.
namespace trait {
using Traits = std::uint32_t;
// What it does to its block and behind it.
inline constexpr Traits kEndsRun = 1U << 0U;    // always; others only where they change something
inline constexpr Traits kTakesAxes = 1U << 1U;  // the axis words belong to no motion
inline constexpr Traits kTakesParameters = 1U << 2U;  // P, Q, L, R, I .. may belong to it
inline constexpr Traits kOwnFeed = 1U << 3U;          // F beside it is no feed
inline constexpr Traits kOwnSpeed = 1U << 4U;         // S beside it is no speed
inline constexpr Traits kLosesPlace = 1U << 5U;       // the tool may be anywhere behind it
inline constexpr Traits kLosesNamed = 1U << 6U;       // the same, of the axes that are named
inline constexpr Traits kCallsAtEnd = 1U << 7U;       // of its block: of a subprogram
inline constexpr Traits kUnknownBehind = 1U << 8U;    // nothing is known behind its block
inline constexpr Traits kNotUnderstood = 1U << 9U;
inline constexpr Traits kNoLengths = 1U << 10U;  // numbers beside it are arguments, times, switches
// Of one group with others that differ from it.
inline constexpr Traits kTilts = 1U << 11U;     // G68.2 ..: the plane; G68 turns in it
inline constexpr Traits kExtended = 1U << 12U;  // G54.1: its number stands in another word
inline constexpr Traits kOldUnits = 1U << 13U;  // G70, G71: units where they stand alone
// For the proof.
inline constexpr Traits kStandsAlone = 1U << 14U;  // means the same without its neighbours
// Said again, it acts again: it hangs on the tool in the spindle (G43), on offsets that were
// changed (G54), or on words beside it or their absence (G64 ends the tolerance of G64 P0.01).
inline constexpr Traits kActsEachTime = 1U << 15U;
// For --convert, and the proof of programs of two languages.
inline constexpr Traits kCommon = 1U << 16U;  // the same on every control that takes it at all
inline constexpr Traits kSilent = 1U << 17U;  // only says how others are read, or ends what was
                                              // refused where it began
// Of drilling cycles.
inline constexpr Traits kPecks = 1U << 18U;
inline constexpr Traits kClearsHole = 1U << 19U;  // comes up to R after each peck
inline constexpr Traits kDwellsBelow = 1U << 20U;
inline constexpr Traits kFeedsOut = 1U << 21U;
inline constexpr Traits kStopsSpindle = 1U << 22U;  // at the bottom
}  // namespace trait

// To what a code sets the item of its group: one of the enums above.
class CodeValue {
 public:
  constexpr CodeValue() = default;
  template <typename Enum>
  constexpr CodeValue(Enum value)  // NOLINT(google-explicit-constructor): rows name values alone
      : raw_(static_cast<std::uint8_t>(value)) {}
  template <typename Enum>
  [[nodiscard]] constexpr Enum as() const {
    return static_cast<Enum>(raw_);
  }

 private:
  std::uint8_t raw_ = 0;
};

struct CodeRow {
  Code code = kNoCode;
  CodeGroup group = CodeGroup::kUnknown;
  CodeValue value;
  std::string_view why;  // the reason why it ends a run
  trait::Traits traits = 0;
  CodeAct act = CodeAct::kNothing;

  [[nodiscard]] constexpr bool is(trait::Traits any) const { return (traits & any) != 0; }
  // G0, G1, G2, G3.
  [[nodiscard]] constexpr bool is_plain_motion() const {
    return group == CodeGroup::kMotion && value.as<MotionMode>() != MotionMode::kOther;
  }
};

// The row of a code; for one that is not in the table, the row of those. G5, G5.1, G8, G50, G70,
// G71 and G92 mean different things to different controls; theirs is the meaning that needs most
// care. M codes are whole; those from M100 on are the user's or the builder's.
[[nodiscard]] const CodeRow& row_of_g(Code code);
[[nodiscard]] const CodeRow& row_of_m(Code code);

// G73 to G89, known or not.
[[nodiscard]] constexpr bool is_cycle(Code code) {
  return code >= 730 && code <= 890 && code != 800;
}

// Can both stand in one block?
[[nodiscard]] bool exclude_each_other(const CodeRow& a, const CodeRow& b);

}  // namespace batten::gcode
