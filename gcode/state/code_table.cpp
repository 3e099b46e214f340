#include "gcode/state/code_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "gcode/state/reason.h"

namespace batten::gcode {
namespace code_rows {

using enum CodeGroup;
using enum CodeAct;
using namespace trait;
using trait::Traits;
namespace why = reason;

// A word that acts, whatever the state was.
constexpr Traits kActs = kEndsRun | kTakesParameters;
constexpr Traits kTakesAll = kActs | kTakesAxes;
constexpr Traits kSet = kStandsAlone;
constexpr Traits kSetEachTime = kStandsAlone | kEndsRun | kActsEachTime;
constexpr Traits kWell = kCommon | kSilent;
constexpr Traits kPlain = kStandsAlone | kWell;  // what every program has
constexpr Traits kOffset = kActs | kStandsAlone | kActsEachTime;
constexpr Traits kLength = kOffset | kLosesPlace;
constexpr Traits kMoves = kTakesAll | kLosesPlace;
constexpr Traits kOwnWords = kTakesAll | kOwnFeed | kOwnSpeed;
constexpr Traits kMacro = kTakesAll | kUnknownBehind | kNoLengths;

constexpr auto kOn = TriState::kOn;
constexpr auto kOff = TriState::kOff;
constexpr auto kOther = MotionMode::kOther;

// Codes that mean the same: a row for each.
struct Codes {
  template <typename... Each>
  constexpr Codes(Each... codes) : each{codes...}, count(sizeof...(codes)) {}
  std::array<Code, 7> each;
  std::size_t count;
};
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): rows of a table
struct Meaning {
  Codes codes;
  CodeGroup group = CodeGroup::kUnknown;
  CodeValue value;
  std::string_view why;
  Traits traits = 0;
  CodeAct act = kNothing;
};

constexpr Meaning kMeaningsOfG[] = {
    {0, kMotion, MotionMode::kRapid, {}, kPlain},
    {10, kMotion, MotionMode::kLine, {}, kPlain},
    {20, kMotion, MotionMode::kClockwise, {}, kPlain},
    {30, kMotion, MotionMode::kCounterclockwise, {}, kPlain},
    {{50, 52, 53, 60, 61, 62, 63}, kMotion, kOther, why::kSpline},  // G5 P alone: high speed mode
    {{310, 382, 383, 384, 385}, kMotion, kOther, why::kProbe},
    {{320, 330, 331, 340, 760}, kMotion, kOther, why::kThreading},
    {{120, 130, 740, 870, 880}, kMotion, kOther, why::kCannedCycle},  // G12, G13: circular pockets
    {{810, 841, 842, 843}, kMotion, kOther, why::kCannedCycle, 0, kDrills},
    {730, kMotion, kOther, why::kCannedCycle, kPecks, kDrills},
    {820, kMotion, kOther, why::kCannedCycle, kDwellsBelow, kDrills},
    {830, kMotion, kOther, why::kCannedCycle, kPecks | kClearsHole, kDrills},
    {{840, 850}, kMotion, kOther, why::kCannedCycle, kFeedsOut, kDrills},
    {860, kMotion, kOther, why::kCannedCycle, kDwellsBelow | kStopsSpindle, kDrills},
    {890, kMotion, kOther, why::kCannedCycle, kDwellsBelow | kFeedsOut, kDrills},
    {800, kCycleEnd, kOther, why::kStateChange, kSetEachTime | kWell},

    // X and U are seconds on FANUC, F and S seconds or turns on Sinumerik; LinuxCNC would move with
    // X.
    {40, kNone, {}, why::kDwell, kOwnWords | kLosesNamed | kNoLengths, kDwell},
    // Exact stop; on Fagor an arc that starts tangentially.
    {90, kNone, {}, why::kExactStop, kEndsRun | kNotUnderstood},
    {1870, kNone, {}, why::kStateChange, kActs},  // Haas: how smooth
    {530, kNone, {}, why::kCoordinateChange, kTakesAll | kLosesNamed, kMachinePlace},
    // Data setting: work and tool offsets, and on FANUC lines of data until G11.
    {100, kAxisUser, {}, why::kCoordinateChange, kTakesAll | kLosesPlace, kWritesData},
    {{280, 300}, kAxisUser, {}, why::kCoordinateChange, kTakesAll, kHome},
    {{281, 301}, kAxisUser, {}, why::kCoordinateChange, kTakesAll, kStoresHome},
    {{520, 921, 922, 923}, kAxisUser, {}, why::kCoordinateChange, kMoves, kMovesOrigin},
    // With S alone it limits the spindle on lathes; with F it is a thread.
    {920, kAxisUser, {}, why::kCoordinateChange, kOwnWords | kLosesNamed, kSetsPlace},
    {650, kAxisUser, {}, why::kSubprogram, kTakesAll | kCallsAtEnd | kNoLengths, kCalls},
    {{660, 661}, kModalMacro, kOn, why::kModalMacro, kMacro, kCalls},
    {670, kModalMacro, kOff, why::kModalMacro, kActs},

    {170, kPlane, Plane::kXY, why::kStateChange, kPlain},
    {180, kPlane, Plane::kZX, why::kStateChange, kPlain},
    {190, kPlane, Plane::kYZ, why::kStateChange, kPlain},
    {200, kUnits, Units::kInch, why::kStateChange, kPlain},
    {210, kUnits, Units::kMillimetre, why::kStateChange, kPlain},
    // Units on old controls, cycles on lathes.
    {700, kUnits, Units::kInch, why::kStateChange, kSet | kSilent | kOldUnits},
    {710, kUnits, Units::kMillimetre, why::kStateChange, kSet | kSilent | kOldUnits},
    {900, kDistance, DistanceMode::kAbsolute, why::kStateChange, kPlain},
    {901, kArcDistance, DistanceMode::kAbsolute, why::kStateChange, kSet | kSilent},
    {910, kDistance, DistanceMode::kIncremental, why::kStateChange, kPlain},
    {911, kArcDistance, DistanceMode::kIncremental, why::kStateChange, kSet | kSilent},
    {930, kFeedMode, FeedMode::kInverseTime, why::kStateChange, kSetEachTime},
    {940, kFeedMode, FeedMode::kPerMinute, why::kStateChange, kSetEachTime | kWell},
    {950, kFeedMode, FeedMode::kPerRevolution, why::kStateChange, kSetEachTime},
    {960, kSpindleMode, kOn, why::kSpindle, kSet | kTakesParameters},  // G96 D.. S..
    {970, kSpindleMode, kOff, why::kSpindle, kSet | kSilent | kTakesParameters},
    {980, kCycleReturn, kOn, why::kStateChange, kSet | kSilent | kEndsRun},
    {990, kCycleReturn, kOff, why::kStateChange, kSet | kSilent | kEndsRun},
    {{600, 611}, kPath, PathMode::kExactStop, why::kStateChange, kSet},
    {610, kPath, PathMode::kExactPath, why::kStateChange, kSet},
    // Corner override, tapping, a tolerance cycle.
    {{620, 630}, kPath, PathMode::kUnknown, why::kStateChange, kActs},
    // P and Q are set anew even when it is repeated.
    {640, kPath, PathMode::kBlending, why::kStateChange, kSetEachTime | kTakesParameters},

    {400, kCutter, kOff, why::kStateChange, kPlain},
    {{410, 411, 420, 421}, kCutter, kOn, why::kCutterCompensation, kSet | kActs},
    {430, kToolLength, TriState::kUnknown, why::kToolChange, kLength | kCommon},
    // Axis words are offsets on LinuxCNC and grbl, a motion on FANUC.
    {{431, 432}, kToolLength, TriState::kUnknown, why::kToolChange, kLength | kTakesAxes},
    {{434, 435}, kToolLength, kOn, why::kToolChange, kLength},
    {440, kToolLength, TriState::kUnknown, why::kToolChange, kLength},
    {490, kToolLength, kOff, why::kToolChange, kLength | kCommon},
    {{540, 550, 560, 570, 580, 590}, kWorkOffset, {}, why::kCoordinateChange, kOffset | kCommon},
    {541, kWorkOffset, {}, why::kCoordinateChange, kOffset | kExtended},
    {{591, 592, 593}, kWorkOffset, {}, why::kCoordinateChange, kOffset},

    {70, kDiameter, kOn, why::kStateChange, kSet},
    {80, kDiameter, kOff, why::kStateChange, kSet},
    {{71, 1070}, kCylindrical, kOn, why::kCylindrical, kSet | kTakesAxes},
    {{121, 1120}, kPolarInterpolation, kOn, why::kPolar, kSet},
    {{131, 1130}, kPolarInterpolation, kOff, why::kPolar, kSet},
    {150, kPolar, kOff, why::kPolar, kSet},
    {160, kPolar, kOn, why::kPolar, kSet},
    {500, kScaling, kOff, why::kScaling, kSet | kTakesAxes | kOwnSpeed},
    {501, kMirror, kOff, why::kMirror, kSet | kTakesAxes},
    {510, kScaling, kOn, why::kScaling, kSet | kTakesAxes},
    {511, kMirror, kOn, why::kMirror, kSet | kTakesAxes},
    {680, kRotation, kOn, why::kRotation, kSet | kTakesAxes},
    {{682, 683, 684}, kRotation, kOn, why::kTiltedPlane, kSet | kTakesAxes | kTilts},
    {690, kRotation, kOff, why::kRotation, kSet},
    {110, kRotation, TriState::kUnknown, why::kStateChange, kActs},  // Okuma; alone it ends G10
    {51, kSmoothing, {}, why::kControlSmoothing, kNoLengths},
    {1300, kSmoothing, kOff, why::kControlSmoothing},
    {1310, kSmoothing, kOn, why::kControlSmoothing},
};

constexpr Meaning kMeaningsOfM[] = {
    {{0, 10}, kStop, {}, why::kProgramEnd, kActs | kCommon, kStops},
    // What follows is no part of the program, or one of its subprograms.
    {{20, 300}, kStop, {}, why::kProgramEnd, kActs | kCommon | kUnknownBehind, kEnds},
    {{30, 40}, kTurning, {}, why::kSpindle, kActs | kCommon, kSpindleOn},
    {50, kTurning, {}, why::kSpindle, kActs | kCommon, kSwitches},
    // The axes may go to a position for it, before or after the motion of its block, and tool
    // offsets may change.
    {60, kNone, {}, why::kToolChange, kActs | kCommon | kLosesPlace, kChangesTool},
    {70, kNone, {}, why::kCoolant, kActs, kSwitches},
    {{80, 90}, kNone, {}, why::kCoolant, kActs | kCommon, kSwitches},
    {190, kNone, {}, why::kSpindle, kActs, kSwitches},
    // Mirror X or Y on some controls, something of the builder's on others.
    {{210, 220}, kNone, TriState::kUnknown, why::kMiscFunction, kActs, kMirrors},
    {230, kNone, kOff, why::kMiscFunction, kActs, kMirrors},
    {{480, 490}, kNone, {}, why::kMiscFunction, kActs, kOverride},
    {600, kStop, {}, why::kProgramEnd, kActs | kLosesPlace, kStops},  // pallet change
    {610, kNone, {}, why::kToolChange, kActs | kLosesPlace, kSwitches},
    // LinuxCNC: back to a saved state.
    {720, kNone, {}, why::kMiscFunction, kActs | kUnknownBehind, kBuilders},
    {{970, 980, 1980}, kNone, {}, why::kSubprogram, kActs | kCallsAtEnd, kCalls},
    {990, kNone, {}, why::kSubprogram, kActs | kUnknownBehind, kCalls},
    {1280, kNone, kOn, why::kMiscFunction, kActs | kLosesPlace, kTurnsToolTip},
    {1290, kNone, kOff, why::kMiscFunction, kActs | kLosesPlace, kTurnsToolTip},
};

constexpr CodeRow kUnknownG = {kNoCode, kUnknown, {}, why::kNotUnderstood, kActs | kNotUnderstood};
constexpr CodeRow kOtherM = {kNoCode, kNone, {}, why::kMiscFunction, kActs, kBuilders};
// LinuxCNC runs a program of that name, others a macro or the PLC. Any of them may move the axes,
// but sees no modal state of ours.
constexpr CodeRow kUserM = {kNoCode, kNone, {}, why::kMiscFunction, kActs | kLosesPlace, kBuilders};

// The rows, and for each code the number of its row, counted from 1.
template <const auto& kMeanings>
struct Rows {
  static constexpr std::size_t kCount = [] {
    std::size_t count = 0;
    for (const Meaning& each : kMeanings) count += each.codes.count;
    return count;
  }();
  static constexpr std::array<CodeRow, kCount> kAll = [] {
    std::array<CodeRow, kCount> rows;
    std::size_t next = 0;
    for (const auto& [codes, group, value, why, traits, act] : kMeanings) {
      for (std::size_t i = 0; i < codes.count; ++i) {
        rows[next++] = {codes.each[i], group, value, why, traits, act};
      }
    }
    return rows;
  }();
  static constexpr std::array<std::uint8_t, 2000> kNumbers = [] {
    std::array<std::uint8_t, 2000> numbers{};
    std::uint8_t number = 0;
    for (const CodeRow& row : kAll) numbers[static_cast<std::size_t>(row.code)] = ++number;
    return numbers;
  }();
  static_assert(kCount <= std::numeric_limits<std::uint8_t>::max());
  static_assert(kNumbers.size() - std::ranges::count(kNumbers, 0) == kCount, "a code has two rows");
  static_assert(std::ranges::all_of(kAll,
                                    [](const CodeRow& row) {
                                      return static_cast<std::size_t>(row.group) < kCodeGroups;
                                    }),
                "kCodeGroups counts up to the last group");

  static const CodeRow& of(Code code, const CodeRow& other) {
    const auto at = static_cast<std::size_t>(code);  // of a negative one: too large
    const std::size_t number = at < kNumbers.size() ? kNumbers[at] : 0;
    return number == 0 ? other : kAll[number - 1];
  }
};

}  // namespace code_rows

Code code_of(const Word& word) {
  // Above every code of every control: the conversion to an integer is safe.
  constexpr double kMostCode = 9999;
  if (!word.is_number || !(word.value >= 0) || word.value > kMostCode) return kNoCode;
  const double tenths = word.value * 10;
  const double whole = std::round(tenths);
  // Far above the rounding of a product of two numbers below 1e5, far below one tenth.
  constexpr double kSameCode = 1e-6;
  return std::abs(tenths - whole) > kSameCode ? kNoCode : static_cast<Code>(whole);
}

const CodeRow& row_of_g(Code code) {
  return code_rows::Rows<code_rows::kMeaningsOfG>::of(code, code_rows::kUnknownG);
}

const CodeRow& row_of_m(Code code) {
  constexpr Code kFirstOfTheUser = 1000;
  return code_rows::Rows<code_rows::kMeaningsOfM>::of(
      code, code >= kFirstOfTheUser ? code_rows::kUserM : code_rows::kOtherM);
}

bool exclude_each_other(const CodeRow& a, const CodeRow& b) {
  return a.group == b.group && a.group != CodeGroup::kUnknown && a.group != CodeGroup::kNone;
}

}  // namespace batten::gcode
