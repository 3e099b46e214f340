// The table of codes, row by row. What the rows mean is tested where they are read (interpreter,
// proof, program time, conversion); here, that each code has the row that it should have.
#include "gcode/state/code_table.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

// A trait is said by its letter.
constexpr std::string_view kLetters = "raqfspncuxltEoAeCSkhdwz";

using enum CodeGroup;
using enum CodeAct;

struct Expected {
  CodeGroup group;
  int value;
  std::string_view why;
  std::string_view traits;
  CodeAct act;
  std::vector<Code> codes;
};

const std::vector<Expected> kG = {
    {kMotion, 1, "", "ACS", kNothing, {0}},
    {kMotion, 2, "", "ACS", kNothing, {10}},
    {kMotion, 3, "", "ACS", kNothing, {20}},
    {kMotion, 4, "", "ACS", kNothing, {30}},
    {kMotion, 5, "spline", "", kNothing, {50, 52, 53, 60, 61, 62, 63}},
    {kMotion, 5, "probe", "", kNothing, {310, 382, 383, 384, 385}},
    {kMotion, 5, "threading", "", kNothing, {320, 330, 331, 340, 760}},
    {kMotion, 5, "canned-cycle", "", kNothing, {120, 130, 740, 870, 880}},
    {kMotion, 5, "canned-cycle", "", kDrills, {810, 841, 842, 843}},
    {kMotion, 5, "canned-cycle", "k", kDrills, {730}},
    {kMotion, 5, "canned-cycle", "kh", kDrills, {830}},
    {kMotion, 5, "canned-cycle", "d", kDrills, {820}},
    {kMotion, 5, "canned-cycle", "w", kDrills, {840, 850}},
    {kMotion, 5, "canned-cycle", "dz", kDrills, {860}},
    {kMotion, 5, "canned-cycle", "dw", kDrills, {890}},
    {kCycleEnd, 5, "state-change", "rAeCS", kNothing, {800}},
    {kNone, 0, "dwell", "raqfsnl", kDwell, {40}},
    {kNone, 0, "exact-stop", "rx", kNothing, {90}},
    {kNone, 0, "state-change", "rq", kNothing, {1870}},
    {kNone, 0, "coordinate-change", "raqn", kMachinePlace, {530}},
    {kAxisUser, 0, "coordinate-change", "raqp", kWritesData, {100}},
    {kAxisUser, 0, "coordinate-change", "raq", kHome, {280, 300}},
    {kAxisUser, 0, "coordinate-change", "raq", kStoresHome, {281, 301}},
    {kAxisUser, 0, "coordinate-change", "raqp", kMovesOrigin, {520, 921, 922, 923}},
    {kAxisUser, 0, "coordinate-change", "raqfsn", kSetsPlace, {920}},
    {kAxisUser, 0, "subprogram", "raqcl", kCalls, {650}},
    {kModalMacro, 1, "modal-macro", "raqul", kCalls, {660, 661}},
    {kModalMacro, 0, "modal-macro", "rq", kNothing, {670}},
    {kPlane, 1, "state-change", "ACS", kNothing, {170}},
    {kPlane, 2, "state-change", "ACS", kNothing, {180}},
    {kPlane, 3, "state-change", "ACS", kNothing, {190}},
    {kUnits, 2, "state-change", "ACS", kNothing, {200}},
    {kUnits, 1, "state-change", "ACS", kNothing, {210}},
    {kUnits, 2, "state-change", "oAS", kNothing, {700}},
    {kUnits, 1, "state-change", "oAS", kNothing, {710}},
    {kDistance, 1, "state-change", "ACS", kNothing, {900}},
    {kDistance, 2, "state-change", "ACS", kNothing, {910}},
    {kArcDistance, 1, "state-change", "AS", kNothing, {901}},
    {kArcDistance, 2, "state-change", "AS", kNothing, {911}},
    {kFeedMode, 2, "state-change", "rAe", kNothing, {930}},
    {kFeedMode, 1, "state-change", "rAeCS", kNothing, {940}},
    {kFeedMode, 3, "state-change", "rAe", kNothing, {950}},
    {kCutter, 0, "state-change", "ACS", kNothing, {400}},
    {kCutter, 1, "cutter-compensation", "rqA", kNothing, {410, 411, 420, 421}},
    {kToolLength, 2, "tool-change", "rqpAeC", kNothing, {430}},
    {kToolLength, 2, "tool-change", "raqpAe", kNothing, {431, 432}},
    {kToolLength, 2, "tool-change", "rqpAe", kNothing, {440}},
    {kToolLength, 1, "tool-change", "rqpAe", kNothing, {434, 435}},
    {kToolLength, 0, "tool-change", "rqpAeC", kNothing, {490}},
    {kWorkOffset, 0, "coordinate-change", "rqAeC", kNothing, {540, 550, 560, 570, 580, 590}},
    {kWorkOffset, 0, "coordinate-change", "rqEAe", kNothing, {541}},
    {kWorkOffset, 0, "coordinate-change", "rqAe", kNothing, {591, 592, 593}},
    {kPath, 3, "state-change", "A", kNothing, {600, 611}},
    {kPath, 2, "state-change", "A", kNothing, {610}},
    {kPath, 0, "state-change", "rq", kNothing, {620, 630}},
    {kPath, 1, "state-change", "rqAe", kNothing, {640}},
    {kSpindleMode, 1, "spindle", "qA", kNothing, {960}},
    {kSpindleMode, 0, "spindle", "qAS", kNothing, {970}},
    {kCycleReturn, 1, "state-change", "rAS", kNothing, {980}},
    {kCycleReturn, 0, "state-change", "rAS", kNothing, {990}},
    {kDiameter, 1, "state-change", "A", kNothing, {70}},
    {kDiameter, 0, "state-change", "A", kNothing, {80}},
    {kScaling, 0, "scaling", "asA", kNothing, {500}},
    {kScaling, 1, "scaling", "aA", kNothing, {510}},
    {kMirror, 0, "mirror", "aA", kNothing, {501}},
    {kMirror, 1, "mirror", "aA", kNothing, {511}},
    {kRotation, 1, "rotation", "aA", kNothing, {680}},
    {kRotation, 1, "tilted-plane", "atA", kNothing, {682, 683, 684}},
    {kRotation, 0, "rotation", "A", kNothing, {690}},
    {kRotation, 2, "state-change", "rq", kNothing, {110}},
    {kPolar, 1, "polar-coordinates", "A", kNothing, {160}},
    {kPolar, 0, "polar-coordinates", "A", kNothing, {150}},
    {kPolarInterpolation, 1, "polar-coordinates", "A", kNothing, {121, 1120}},
    {kPolarInterpolation, 0, "polar-coordinates", "A", kNothing, {131, 1130}},
    {kCylindrical, 1, "cylindrical", "aA", kNothing, {71, 1070}},
    {kSmoothing, 0, "control-smoothing", "l", kNothing, {51}},
    {kSmoothing, 0, "control-smoothing", "", kNothing, {1300}},
    {kSmoothing, 1, "control-smoothing", "", kNothing, {1310}},
};

const std::vector<Expected> kM = {
    {kStop, 0, "program-end", "rqC", kStops, {0, 10}},
    {kStop, 0, "program-end", "rquC", kEnds, {20, 300}},
    {kStop, 0, "program-end", "rqp", kStops, {600}},
    {kTurning, 0, "spindle", "rqC", kSpindleOn, {30, 40}},
    {kTurning, 0, "spindle", "rqC", kSwitches, {50}},
    {kNone, 0, "spindle", "rq", kSwitches, {190}},
    {kNone, 0, "tool-change", "rqpC", kChangesTool, {60}},
    {kNone, 0, "tool-change", "rqp", kSwitches, {610}},
    {kNone, 0, "coolant", "rq", kSwitches, {70}},
    {kNone, 0, "coolant", "rqC", kSwitches, {80, 90}},
    {kNone, 2, "misc-function", "rq", kMirrors, {210, 220}},
    {kNone, 0, "misc-function", "rq", kMirrors, {230}},
    {kNone, 0, "misc-function", "rq", kOverride, {480, 490}},
    {kNone, 0, "misc-function", "rqu", kBuilders, {720}},
    {kNone, 0, "subprogram", "rqc", kCalls, {970, 980, 1980}},
    {kNone, 0, "subprogram", "rqu", kCalls, {990}},
    {kNone, 1, "misc-function", "rqp", kTurnsToolTip, {1280}},
    {kNone, 0, "misc-function", "rqp", kTurnsToolTip, {1290}},
};
const Expected kUnknownG = {kUnknown, 0, "not-understood", "rqx", kNothing, {}};
const Expected kOtherM = {kNone, 0, "misc-function", "rq", kBuilders, {}};
const Expected kUserM = {kNone, 0, "misc-function", "rqp", kBuilders, {}};

std::string letters_of(trait::Traits traits) {
  std::string letters;
  for (std::size_t i = 0; i < kLetters.size(); ++i) {
    if ((traits >> i & 1U) != 0) letters += kLetters[i];
  }
  return letters;
}

void expect_row(const CodeRow& row, Code code, const Expected& expected) {
  SCOPED_TRACE(code);
  EXPECT_EQ(row.code, code);
  EXPECT_EQ(row.group, expected.group);
  EXPECT_EQ(static_cast<int>(row.value.as<std::uint8_t>()), expected.value);
  EXPECT_EQ(row.why, expected.why);
  EXPECT_EQ(letters_of(row.traits), expected.traits);
  EXPECT_EQ(row.act, expected.act);
}

void expect_rows(const CodeRow& (*row_of)(Code), const std::vector<Expected>& rows,
                 const Expected& other, const Expected& from_1000) {
  std::map<Code, const Expected*> known;
  for (const Expected& each : rows) {
    for (const Code code : each.codes) EXPECT_TRUE(known.emplace(code, &each).second) << code;
  }
  for (Code code = -1; code < 99990; ++code) {
    const auto row = known.find(code);
    if (row != known.end()) {
      expect_row(row_of(code), code, *row->second);
    } else if (row_of(code).code != kNoCode || code % 999 == 0) {
      expect_row(row_of(code), kNoCode, code < 1000 ? other : from_1000);
    }
  }
}

TEST(CodeTable, EachCodeHasItsRow) {
  expect_rows(row_of_g, kG, kUnknownG, kUnknownG);
  expect_rows(row_of_m, kM, kOtherM, kUserM);
}

// In a program that has said nothing else, a code that ends a run does so for the reason of its
// row.
TEST(CodeTable, TheReasonOfTheRowStandsInTheBlock) {
  for (const auto* rows : {&kG, &kM}) {
    for (const Expected& each : *rows) {
      for (const Code code : each.codes) {
        const std::string word = (rows == &kG ? "G" : "M") + std::to_string(code / 10) +
                                 (code % 10 == 0 ? "" : "." + std::to_string(code % 10));
        SCOPED_TRACE(word);
        const tests::Interpreted it("X1\n" + word + "\n");
        // G69 ends a tilted plane, too, and that first. G0 .. G3 alone change the mode.
        const std::string_view why = code == 690 && rows == &kG ? "tilted-plane"
                                     : each.why.empty()         ? "state-change"
                                                                : each.why;
        EXPECT_EQ(it.line(2).barrier.id(), why);
      }
    }
  }
}

TEST(CodeTable, AWordHasACodeOfAtMostOneDecimal) {
  const auto code = [](double value, bool is_number = true) {
    return code_of({.is_number = is_number, .value = value, .span = {}});
  };
  EXPECT_EQ(code(1), 10);
  EXPECT_EQ(code(38.2), 382);
  EXPECT_EQ(code(0), 0);
  EXPECT_EQ(code(1.25), kNoCode);
  EXPECT_EQ(code(-3), kNoCode);
  EXPECT_EQ(code(10000), kNoCode);
  EXPECT_EQ(code(1, false), kNoCode);
}

}  // namespace
}  // namespace batten::gcode
