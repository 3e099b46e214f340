#include "gcode/state/code_table.h"

#include <array>
#include <cmath>
#include <cstddef>

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

constexpr auto kOn = TriState::kOn;
constexpr auto kOff = TriState::kOff;
constexpr auto kOther = MotionMode::kOther;

constexpr CodeRow kG[] = {
    {0, kMotion, MotionMode::kRapid, {}, kPlain},
    {10, kMotion, MotionMode::kLine, {}, kPlain},
    {20, kMotion, MotionMode::kClockwise, {}, kPlain},
    {30, kMotion, MotionMode::kCounterclockwise, {}, kPlain},
    // X and U are seconds on FANUC, F and S seconds or turns on Sinumerik; LinuxCNC would move with
    // X.
    {40,
     kNone,
     {},
     why::kDwell,
     kTakesAll | kLosesNamed | kOwnFeed | kOwnSpeed | kNoLengths,
     kDwell},
    {50, kMotion, kOther, why::kSpline},  // with P alone a high speed mode
    {51, kSmoothing, {}, why::kControlSmoothing, kNoLengths},
    {52, kMotion, kOther, why::kSpline},
    {53, kMotion, kOther, why::kSpline},
    {60, kMotion, kOther, why::kSpline},
    {61, kMotion, kOther, why::kSpline},
    {62, kMotion, kOther, why::kSpline},
    {63, kMotion, kOther, why::kSpline},
    {70, kDiameter, kOn, why::kStateChange, kSet},
    {71, kCylindrical, kOn, why::kCylindrical, kSet | kTakesAxes},
    {80, kDiameter, kOff, why::kStateChange, kSet},
    // Exact stop; on Fagor an arc that starts tangentially.
    {90, kNone, {}, why::kExactStop, kEndsRun | kNotUnderstood},
    // Data setting: work and tool offsets, and on FANUC lines of data until G11.
    {100, kAxisUser, {}, why::kCoordinateChange, kTakesAll | kLosesPlace, kWritesData},
    {110, kNone, {}, why::kStateChange, kActs},
    {120, kMotion, kOther, why::kCannedCycle},  // circular pockets
    {121, kPolar, kOn, why::kPolar, kSet},
    {130, kMotion, kOther, why::kCannedCycle},
    {131, kPolar, kOff, why::kPolar, kSet},
    {150, kPolar, kOff, why::kPolar, kSet},
    {160, kPolar, kOn, why::kPolar, kSet},
    {170, kPlane, Plane::kXY, why::kStateChange, kPlain},
    {180, kPlane, Plane::kZX, why::kStateChange, kPlain},
    {190, kPlane, Plane::kYZ, why::kStateChange, kPlain},
    {200, kUnits, Units::kInch, why::kStateChange, kPlain},
    {210, kUnits, Units::kMillimetre, why::kStateChange, kPlain},
    {280, kAxisUser, {}, why::kCoordinateChange, kTakesAll, kHome},
    {281, kAxisUser, {}, why::kCoordinateChange, kTakesAll, kStoresHome},
    {300, kAxisUser, {}, why::kCoordinateChange, kTakesAll, kHome},
    {301, kAxisUser, {}, why::kCoordinateChange, kTakesAll, kStoresHome},
    {310, kMotion, kOther, why::kProbe},
    {320, kMotion, kOther, why::kThreading},
    {330, kMotion, kOther, why::kThreading},
    {331, kMotion, kOther, why::kThreading},
    {340, kMotion, kOther, why::kThreading},
    {382, kMotion, kOther, why::kProbe},
    {383, kMotion, kOther, why::kProbe},
    {384, kMotion, kOther, why::kProbe},
    {385, kMotion, kOther, why::kProbe},
    {400, kCutter, kOff, why::kStateChange, kPlain},
    {410, kCutter, kOn, why::kCutterCompensation, kSet | kActs},
    {411, kCutter, kOn, why::kCutterCompensation, kSet | kActs},
    {420, kCutter, kOn, why::kCutterCompensation, kSet | kActs},
    {421, kCutter, kOn, why::kCutterCompensation, kSet | kActs},
    {430, kToolLength, TriState::kUnknown, why::kToolChange, kLength | kCommon},
    // Axis words are offsets on LinuxCNC and grbl, a motion on FANUC.
    {431, kToolLength, TriState::kUnknown, why::kToolChange, kLength | kTakesAxes},
    {432, kToolLength, TriState::kUnknown, why::kToolChange, kLength | kTakesAxes},
    {434, kToolLength, kOn, why::kToolChange, kLength},
    {435, kToolLength, kOn, why::kToolChange, kLength},
    {440, kToolLength, TriState::kUnknown, why::kToolChange, kLength},
    {490, kToolLength, kOff, why::kToolChange, kLength | kCommon},
    {500, kScaling, kOff, why::kScaling, kSet | kTakesAxes | kOwnSpeed},
    {501, kMirror, kOff, why::kMirror, kSet | kTakesAxes},
    {510, kScaling, kOn, why::kScaling, kSet | kTakesAxes},
    {511, kMirror, kOn, why::kMirror, kSet | kTakesAxes},
    {520, kAxisUser, {}, why::kCoordinateChange, kTakesAll | kLosesPlace, kMovesOrigin},
    {530, kNone, {}, why::kCoordinateChange, kTakesAll | kLosesNamed, kMachinePlace},
    {540, kWorkOffset, {}, why::kCoordinateChange, kOffset | kCommon},
    {541, kWorkOffset, {}, why::kCoordinateChange, kOffset | kExtended},
    {550, kWorkOffset, {}, why::kCoordinateChange, kOffset | kCommon},
    {560, kWorkOffset, {}, why::kCoordinateChange, kOffset | kCommon},
    {570, kWorkOffset, {}, why::kCoordinateChange, kOffset | kCommon},
    {580, kWorkOffset, {}, why::kCoordinateChange, kOffset | kCommon},
    {590, kWorkOffset, {}, why::kCoordinateChange, kOffset | kCommon},
    {591, kWorkOffset, {}, why::kCoordinateChange, kOffset},
    {592, kWorkOffset, {}, why::kCoordinateChange, kOffset},
    {593, kWorkOffset, {}, why::kCoordinateChange, kOffset},
    {600, kPath, PathMode::kExactStop, why::kStateChange, kSet},
    {610, kPath, PathMode::kExactPath, why::kStateChange, kSet},
    {611, kPath, PathMode::kExactStop, why::kStateChange, kSet},
    // Corner override, tapping, a tolerance cycle.
    {620, kPath, PathMode::kUnknown, why::kStateChange, kActs},
    {630, kPath, PathMode::kUnknown, why::kStateChange, kActs},
    // P and Q are set anew even when it is repeated.
    {640, kPath, PathMode::kBlending, why::kStateChange, kSetEachTime | kTakesParameters},
    {650, kAxisUser, {}, why::kSubprogram, kTakesAll | kCallsAtEnd | kNoLengths, kCalls},
    {660, kModalMacro, kOn, why::kModalMacro, kTakesAll | kUnknownBehind | kNoLengths, kCalls},
    {661, kModalMacro, kOn, why::kModalMacro, kTakesAll | kUnknownBehind | kNoLengths, kCalls},
    {670, kModalMacro, kOff, why::kModalMacro, kActs},
    {680, kRotation, kOn, why::kRotation, kSet | kTakesAxes},
    {682, kRotation, kOn, why::kTiltedPlane, kSet | kTakesAxes | kTilts},
    {683, kRotation, kOn, why::kTiltedPlane, kSet | kTakesAxes | kTilts},
    {684, kRotation, kOn, why::kTiltedPlane, kSet | kTakesAxes | kTilts},
    {690, kRotation, kOff, why::kRotation, kSet},
    // Units on old controls, cycles on lathes.
    {700, kUnits, Units::kInch, why::kStateChange, kSet | kSilent | kOldUnits},
    {710, kUnits, Units::kMillimetre, why::kStateChange, kSet | kSilent | kOldUnits},
    {730, kMotion, kOther, why::kCannedCycle, kPecks, kDrills},
    {740, kMotion, kOther, why::kCannedCycle},
    {760, kMotion, kOther, why::kThreading},
    {800, kCycleEnd, kOther, why::kStateChange, kSetEachTime | kWell},
    {810, kMotion, kOther, why::kCannedCycle, 0, kDrills},
    {820, kMotion, kOther, why::kCannedCycle, kDwellsBelow, kDrills},
    {830, kMotion, kOther, why::kCannedCycle, kPecks | kClearsHole, kDrills},
    {840, kMotion, kOther, why::kCannedCycle, kFeedsOut, kDrills},
    {841, kMotion, kOther, why::kCannedCycle, 0, kDrills},
    {842, kMotion, kOther, why::kCannedCycle, 0, kDrills},
    {843, kMotion, kOther, why::kCannedCycle, 0, kDrills},
    {850, kMotion, kOther, why::kCannedCycle, kFeedsOut, kDrills},
    {860, kMotion, kOther, why::kCannedCycle, kDwellsBelow | kStopsSpindle, kDrills},
    {870, kMotion, kOther, why::kCannedCycle},
    {880, kMotion, kOther, why::kCannedCycle},
    {890, kMotion, kOther, why::kCannedCycle, kDwellsBelow | kFeedsOut, kDrills},
    {900, kDistance, DistanceMode::kAbsolute, why::kStateChange, kPlain},
    {901, kArcDistance, DistanceMode::kAbsolute, why::kStateChange, kSet | kSilent},
    {910, kDistance, DistanceMode::kIncremental, why::kStateChange, kPlain},
    {911, kArcDistance, DistanceMode::kIncremental, why::kStateChange, kSet | kSilent},
    // With S alone it limits the spindle on lathes; with F it is a thread.
    {920,
     kAxisUser,
     {},
     why::kCoordinateChange,
     kTakesAll | kLosesNamed | kOwnFeed | kOwnSpeed,
     kSetsPlace},
    {921, kAxisUser, {}, why::kCoordinateChange, kTakesAll | kLosesPlace, kMovesOrigin},
    {922, kAxisUser, {}, why::kCoordinateChange, kTakesAll | kLosesPlace, kMovesOrigin},
    {923, kAxisUser, {}, why::kCoordinateChange, kTakesAll | kLosesPlace, kMovesOrigin},
    {930, kFeedMode, FeedMode::kInverseTime, why::kStateChange, kSetEachTime},
    {940, kFeedMode, FeedMode::kPerMinute, why::kStateChange, kSetEachTime | kWell},
    {950, kFeedMode, FeedMode::kPerRevolution, why::kStateChange, kSetEachTime},
    // G96 D.. S..
    {960, kSpindleMode, kOn, why::kSpindle, kSet | kTakesParameters},
    {970, kSpindleMode, kOff, why::kSpindle, kSet | kSilent | kTakesParameters},
    {980, kCycleReturn, kOn, why::kStateChange, kSet | kSilent | kEndsRun},
    {990, kCycleReturn, kOff, why::kStateChange, kSet | kSilent | kEndsRun},
    {1070, kCylindrical, kOn, why::kCylindrical, kSet | kTakesAxes},
    {1120, kPolar, kOn, why::kPolar, kSet},
    {1130, kPolar, kOff, why::kPolar, kSet},
    {1300, kSmoothing, kOff, why::kControlSmoothing},
    {1310, kSmoothing, kOn, why::kControlSmoothing},
    {1870, kNone, {}, why::kStateChange, kActs},  // Haas: how smooth
};

constexpr CodeRow kM[] = {
    {0, kStop, {}, why::kProgramEnd, kActs | kCommon, kStops},
    {10, kStop, {}, why::kProgramEnd, kActs | kCommon, kStops},
    // What follows is no part of the program, or one of its subprograms.
    {20, kStop, {}, why::kProgramEnd, kActs | kCommon | kUnknownBehind, kEnds},
    {30, kTurning, {}, why::kSpindle, kActs | kCommon, kSpindleOn},
    {40, kTurning, {}, why::kSpindle, kActs | kCommon, kSpindleOn},
    {50, kTurning, {}, why::kSpindle, kActs | kCommon, kSwitches},
    // The axes may go to a place for it, before or after the motion of its block, and tool offsets
    // may change.
    {60, kNone, {}, why::kToolChange, kActs | kCommon | kLosesPlace, kChangesTool},
    {70, kNone, {}, why::kCoolant, kActs, kSwitches},
    {80, kNone, {}, why::kCoolant, kActs | kCommon, kSwitches},
    {90, kNone, {}, why::kCoolant, kActs | kCommon, kSwitches},
    {190, kNone, {}, why::kSpindle, kActs, kSwitches},
    // Mirror X or Y on some controls, something of the builder's on others.
    {210, kNone, TriState::kUnknown, why::kMiscFunction, kActs, kMirrors},
    {220, kNone, TriState::kUnknown, why::kMiscFunction, kActs, kMirrors},
    {230, kNone, kOff, why::kMiscFunction, kActs, kMirrors},
    {300, kStop, {}, why::kProgramEnd, kActs | kCommon | kUnknownBehind, kEnds},
    {480, kNone, {}, why::kMiscFunction, kActs, kOverride},
    {490, kNone, {}, why::kMiscFunction, kActs, kOverride},
    {600, kStop, {}, why::kProgramEnd, kActs | kLosesPlace, kStops},  // pallet change
    {610, kNone, {}, why::kToolChange, kActs | kLosesPlace, kSwitches},
    // LinuxCNC: back to a saved state.
    {720, kNone, {}, why::kMiscFunction, kActs | kUnknownBehind, kBuilders},
    {970, kNone, {}, why::kSubprogram, kActs | kCallsAtEnd, kCalls},
    {980, kNone, {}, why::kSubprogram, kActs | kCallsAtEnd, kCalls},
    {990, kNone, {}, why::kSubprogram, kActs | kUnknownBehind, kCalls},
    {1280, kNone, kOn, why::kMiscFunction, kActs | kLosesPlace, kTurnsToolTip},
    {1290, kNone, kOff, why::kMiscFunction, kActs | kLosesPlace, kTurnsToolTip},
    {1980, kNone, {}, why::kSubprogram, kActs | kCallsAtEnd, kCalls},
};

constexpr CodeRow kUnknownG = {kNoCode, kUnknown, {}, why::kNotUnderstood, kActs | kNotUnderstood};
constexpr CodeRow kOtherM = {kNoCode, kNone, {}, why::kMiscFunction, kActs, kBuilders};
// LinuxCNC runs a program of that name, others a macro or the PLC. Any of them may move the axes,
// but sees no modal state of ours.
constexpr CodeRow kUserM = {kNoCode, kNone, {}, why::kMiscFunction, kActs | kLosesPlace, kBuilders};
constexpr Code kFirstOfTheUser = 1000;

// For each code its place in the table, counted from 1.
consteval auto places_of(const auto& rows) {
  std::array<std::uint8_t, 2000> places{};
  std::uint8_t place = 0;
  for (const CodeRow& row : rows) places.at(static_cast<std::size_t>(row.code)) = ++place;
  return places;
}
constexpr auto kPlacesG = places_of(kG);
constexpr auto kPlacesM = places_of(kM);

constexpr std::size_t place_in(const auto& places, Code code) {
  const auto at = static_cast<std::size_t>(code);  // of a negative one: too large
  return at < places.size() ? places[at] : 0;
}

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
  const std::size_t place = code_rows::place_in(code_rows::kPlacesG, code);
  return place == 0 ? code_rows::kUnknownG : code_rows::kG[place - 1];
}

const CodeRow& row_of_m(Code code) {
  const std::size_t place = code_rows::place_in(code_rows::kPlacesM, code);
  if (place == 0)
    return code >= code_rows::kFirstOfTheUser ? code_rows::kUserM : code_rows::kOtherM;
  return code_rows::kM[place - 1];
}

bool exclude_each_other(const CodeRow& a, const CodeRow& b) {
  return a.group == b.group && a.group != CodeGroup::kUnknown && a.group != CodeGroup::kNone;
}

}  // namespace batten::gcode
