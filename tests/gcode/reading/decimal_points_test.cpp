// What a number without a decimal point means, where it may mean two things.
#include "gcode/reading/decimal_points.h"

#include <gtest/gtest.h>

#include <string>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/source_kind.h"
#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

constexpr Decimals kUndeclaredDecimals{.pointless = PointlessNumbers::kUndeclared};
constexpr Decimals kIncrements{.pointless = PointlessNumbers::kIncrements};

struct ReadWith {
  ReadWith(const std::string& text, const Decimals& decimals, Units units = Units::kUnknown)
      : program(parse(SourceText("test.nc", text), {Language::kRs274, decimals, units}, found)),
        meaning(interpret(program, {.units = units}, found)) {}

  // Of the last block that has it.
  [[nodiscard]] const Word& word(char letter) const {
    const Word* last = nullptr;
    for (const Word& each : program.words) {
      if (each.letter == letter) last = &each;
    }
    return *last;
  }

  Diagnostics found;
  Program program;
  Interpretation meaning;
};

struct ValueCase {
  const char* text;
  char letter;
  double value;
};

const ValueCase kImpliedRows[] = {{"G21 G1 X1234", 'X', 1.234},
                                  {"G21 G1 Z-5", 'Z', -0.005},
                                  {"G21 G1 X0", 'X', 0},
                                  {"G21 G1 X1234.", 'X', 1234},
                                  {"G21 G1 X.5", 'X', 0.5},
                                  {"G20 G1 X1234", 'X', 0.1234},
                                  {"G21\nG20 G1 X12345", 'X', 1.2345},
                                  {"G70\nG1 X12345", 'X', 1.2345},
                                  {"G21\nG70 P1 Q2\nG1 X1234", 'X', 1.234},
                                  {"G21 G2 X1. Y0 I500", 'I', 0.5},
                                  {"G21 G18 G2 X1. Z0 K500", 'K', 0.5},
                                  {"G21 G2 X1. Y0 R1500", 'R', 1.5},
                                  {"G21 G1 U250", 'U', 0.25},
                                  {"G21 G83 X0 Y0 Z-5. R2. Q1500", 'Q', 1.5},
                                  {"G21 G81 X0 Y0 Z-5. R2. K3", 'K', 3},
                                  {"G21 G81 Z-5. R2.\nX5. K3", 'K', 3},
                                  {"G21 G81 Z-5. R2.\nG80\nG18 G2 K500", 'K', 0.5},
                                  {"G21 G4 X1000", 'X', 1000},
                                  {"G21 G4 P1000", 'P', 1000},
                                  {"G21 G65 P9010 X100", 'X', 100},
                                  {"G21 G5 P10000", 'P', 10000},
                                  {"G21 G5.1 Q2", 'Q', 2},
                                  {"G21 G1 X1. F1200", 'F', 1200},
                                  {"G21 S8000 M3", 'S', 8000},
                                  {"G21 G0 A90", 'A', 90}};

// As if the point had been written: not nearly, but the same double.
TEST(Implied, NumbersHaveTheirValueInTheProgramsUnits) {
  for (const ValueCase& test : kImpliedRows) {
    SCOPED_TRACE(test.text);
    const ReadWith it(test.text, kIncrements);
    EXPECT_TRUE(it.word(test.letter).is_number);
    EXPECT_EQ(it.word(test.letter).value, test.value);
  }
}

TEST(DecimalPoints, OtherIncrementsAreATenthInInches) {
  const Decimals fine{.pointless = PointlessNumbers::kIncrements, .increment_decimals = 4};
  EXPECT_EQ(ReadWith("G21 G1 X12345", fine).word('X').value, 1.2345);
  EXPECT_EQ(ReadWith("G20 G1 X12345", fine).word('X').value, 0.12345);
  const Decimals whole{.pointless = PointlessNumbers::kIncrements, .increment_decimals = 0};
  EXPECT_EQ(ReadWith("G21 G1 X12", whole).word('X').value, 12);
}

TEST(DecimalPoints, UnitsOfAProgramThatNamesNone) {
  EXPECT_EQ(ReadWith("G1 X12345", kIncrements, Units::kInch).word('X').value, 1.2345);
  EXPECT_EQ(ReadWith("G1 X12345", kIncrements, Units::kMillimetre).word('X').value, 12.345);
}

TEST(DecimalPoints, ScaledNumbersHaveTheDecimalsOfTheIncrement) {
  EXPECT_EQ(ReadWith("G21 G1 X1234", kIncrements).word('X').decimals, 3);
  EXPECT_EQ(ReadWith("G20 G1 X1234", kIncrements).word('X').decimals, 4);
}

TEST(DecimalPoints, MotionsGoWhereTheIncrementsSay) {
  const ReadWith it("G21 G90\nG0 X0 Y0 Z5000\nG1 X10000 Y-2500 F300\n", kIncrements);
  ASSERT_EQ(it.meaning.motions.size(), 2U);
  const geometry::Point3 end = geometry::end_point(it.meaning.motions.back().piece);
  EXPECT_EQ(end, geometry::Point3(10, -2.5, 5));
}

TEST(DecimalPoints, ExplicitIsWhatItSays) {
  const ReadWith it("G21 G1 X1234 F10", {});
  EXPECT_EQ(it.word('X').value, 1234);
  EXPECT_FALSE(it.word('X').without_point);
  EXPECT_FALSE(it.word('F').without_point);
}

// --- nobody said --------------------------------------------------------------------------------

TEST(UndeclaredDecimals, LengthsHaveNoValueAndEndRunsWithTheirReason) {
  const ReadWith it("G21 G90 F100.\nG0 X0 Y0 Z0\nG1 X1.\nX1000\nY5.\nX2.\nX3.\n",
                    kUndeclaredDecimals);
  EXPECT_EQ(it.meaning.blocks[3].barrier, reason::kImpliedDecimals);
  EXPECT_EQ(it.meaning.blocks[3].kind, BlockKind::kOpaque);
  EXPECT_EQ(it.meaning.blocks[3].motion, -1);
  // Y is where it was; X is known again after the next word of it.
  ASSERT_EQ(it.meaning.motions.size(), 5U);
  EXPECT_TRUE(it.meaning.motions[2].start_known);
  EXPECT_FALSE(it.meaning.motions[3].start_known);
  EXPECT_TRUE(it.meaning.motions[4].start_known);
}

TEST(UndeclaredDecimals, ZeroIsZero) {
  const ReadWith it("G21 G90 F100.\nG0 X0 Y0 Z-0\nG1 X00 Y0\n", kUndeclaredDecimals);
  EXPECT_TRUE(it.found.empty());
  EXPECT_EQ(it.meaning.motions.size(), 2U);
}

TEST(UndeclaredDecimals, AreToldOnceAtTheFirst) {
  const ReadWith it("G21 G90 F100\nG0 X0 Y0\nG1 X1.\nX1000 Y1000\nY-5\n", kUndeclaredDecimals);
  ASSERT_EQ(it.found.size(), 1U);
  EXPECT_EQ(it.found[0].id, "implied-decimals");
  EXPECT_EQ(it.found[0].severity, Severity::kWarning);
  EXPECT_EQ(it.program.source.text(it.found[0].where), "X1000");
  EXPECT_EQ(it.found[0].message,
            "X1000 has no decimal point: X1000. on some of these controls, 1000 least increments "
            "on others. 2 blocks of this kind stay as they are. Say --decimals explicit or "
            "--decimals implied");
}

TEST(UndeclaredDecimals, OtherWordsOfTheBlockDoWhatTheySay) {
  const ReadWith it("G21\nG0 G91 G55 X100 F30. S500 M3\n", kUndeclaredDecimals);
  const ModalState& now = it.meaning.states.back();
  EXPECT_EQ(now.distance, DistanceMode::kIncremental);
  EXPECT_EQ(now.feed, 30.0);
  EXPECT_EQ(now.spindle_speed, 500.0);
}

TEST(UndeclaredDecimals, NoCodesCountsAnglesAndTimes) {
  const ReadWith it(
      "G21 G4 X1000\nG4 P500\nG65 P9010 X5\nG81 R2. Z-1. K3\nX2. K3\nG80\nG5 P10000\n"
      "G5.1 Q1\nT5 M6\nM98 P1000 L2\nG43 H1\nG1 A90\nN5\nF100\nS500\n",
      kUndeclaredDecimals);
  for (const Diagnostic& each : it.found) EXPECT_NE(each.id, "implied-decimals");
}

// How a feed without a point is counted says another parameter: no one form becomes the other.
TEST(UndeclaredDecimals, FeedsAreMarked) {
  const ReadWith it("G21 G90\nG0 X0 Y0\nG1 X1. F100\nX2.\nX3. F200\nX4. F200.\n",
                    kUndeclaredDecimals);
  EXPECT_TRUE(it.meaning.states[it.meaning.blocks[4].state_after].feed_without_point);
  EXPECT_EQ(it.meaning.blocks[4].barrier, std::string_view());
  EXPECT_FALSE(it.meaning.states[it.meaning.blocks[5].state_after].feed_without_point);
  EXPECT_EQ(it.meaning.blocks[5].barrier, reason::kStateChange);
}

// Whether a knot is counted in increments differs from control to control.
TEST(DecimalPoints, KnotsAndWeightsNeedTheirPoint) {
  const ReadWith it("G21 G0 X0 Y0 Z0\nG6.2 P4 K0. X0. Y0. R1. F100.\nK40 X40. Y0.\nG1 X5000\n",
                    kIncrements);
  EXPECT_FALSE(it.program.words_of(it.program.blocks[2])[0].is_number);
  EXPECT_EQ(it.word('X').value, 5);
}

// --- who has such numbers -----------------------------------------------------------------------

struct WhoCase {
  SourceKind source;
  const char* target;  // empty: none
  PointlessNumbers expected;
};

constexpr PointlessNumbers kNobodySaid = PointlessNumbers::kUndeclared;
constexpr PointlessNumbers kPlain = PointlessNumbers::kUnits;

const WhoCase kWhoHasSuchNumbersRows[] = {{SourceKind::kFanuc, "", kNobodySaid},
                                          {SourceKind::kHaas, "", kNobodySaid},
                                          {SourceKind::kNgc, "", kPlain},
                                          {SourceKind::kGrbl, "", kPlain},
                                          {SourceKind::kAuto, "", kPlain},
                                          {SourceKind::kAuto, "fanuc", kNobodySaid},
                                          {SourceKind::kAuto, "syntec", kNobodySaid},
                                          {SourceKind::kAuto, "mitsubishi", kNobodySaid},
                                          {SourceKind::kAuto, "haas", kNobodySaid},
                                          {SourceKind::kAuto, "mazak", kNobodySaid},
                                          {SourceKind::kAuto, "okuma", kNobodySaid},
                                          {SourceKind::kAuto, "brother", kNobodySaid},
                                          {SourceKind::kAuto, "hurco", kNobodySaid},
                                          {SourceKind::kAuto, "fagor", kPlain},
                                          {SourceKind::kAuto, "linuxcnc", kPlain},
                                          {SourceKind::kAuto, "grbl", kPlain},
                                          {SourceKind::kAuto, "marlin", kPlain},
                                          {SourceKind::kNgc, "fanuc", kPlain},
                                          {SourceKind::kFanuc, "linuxcnc", kNobodySaid}};

TEST(WhoHasSuchNumbers, IsSaidByTheSourceThenTheTarget) {
  for (const WhoCase& test : kWhoHasSuchNumbersRows) {
    SCOPED_TRACE(test.target);
    const std::string target = test.target;
    const Control* control = target.empty() ? nullptr : find_control(target);
    EXPECT_EQ(target.empty(), control == nullptr);
    EXPECT_EQ(decimals_read(test.source, control, Language::kRs274, {}).pointless, test.expected);
  }
}

TEST(Decimals, OtherLanguagesHaveNoSuchNumbers) {
  for (const Language language : {Language::kSiemens, Language::kKlartext}) {
    EXPECT_EQ(decimals_read(SourceKind::kAuto, find_control("fanuc"), language, kIncrements),
              gcode::Decimals{});
  }
}

TEST(Decimals, WhatTheUserSaysCounts) {
  EXPECT_EQ(decimals_read(SourceKind::kFanuc, nullptr, Language::kRs274, kIncrements), kIncrements);
  EXPECT_EQ(decimals_read(SourceKind::kFanuc, nullptr, Language::kRs274, gcode::Decimals{}),
            gcode::Decimals{});
}

// A profile whose numbers have no point says how its control reads them.
TEST(Decimals, AProfileThatWritesNoPointNeedsNone) {
  for (const char* name : {"fanuc", "haas"}) {
    Control mine = *find_control(name);
    EXPECT_TRUE(may_imply_decimals(mine)) << name;
    mine.decimal_point = false;
    EXPECT_FALSE(may_imply_decimals(mine)) << name;
  }
}

}  // namespace
}  // namespace batten::gcode
