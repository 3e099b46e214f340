// What Klartext programs do: motions in millimetres, and what is known after each construct.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gcode/curves/heidenhain_spl.h"
#include "gcode/interpreter/program_flow.h"
#include "gcode/state/reason.h"
#include "tests/support/klartext_programs.h"

namespace batten::gcode {
namespace {

using geometry::Point3;
using tests::KlartextProgram;

const std::string kHead = "0 BEGIN PGM PART MM\n1 L X+0 Y+0 R0 FMAX M3\n2 L Z+0 F500\n";

// Line 4 is the first one of `lines`.
KlartextProgram program_with(const std::string& lines) { return KlartextProgram(kHead + lines); }

TEST(KlartextMotions, GoWhereTheBlocksSay) {
  const KlartextProgram p = program_with("3 L X+1,5 Y-2\n4 L X+9 FMAX\n5 L Z-1\n");
  const Motion& line = *p.motion_of(4);
  EXPECT_EQ(line.kind, MotionKind::kLine);
  EXPECT_EQ(geometry::end_point(line.piece), Point3(1.5, -2, 0));
  EXPECT_TRUE(p.line(4).barrier.empty());
  EXPECT_EQ(p.motion_of(5)->kind, MotionKind::kRapid);
  // FMAX counts in its block only.
  EXPECT_EQ(p.motion_of(6)->kind, MotionKind::kLine);
  EXPECT_EQ(p.state_after(6).feed, 500);
  EXPECT_EQ(geometry::end_point(p.motion_of(6)->piece), Point3(9, -2, -1));
  EXPECT_TRUE(p.found.empty());
}

TEST(KlartextMotions, AreReadInInches) {
  const KlartextProgram p("0 BEGIN PGM A INCH\n1 L X+0 Y+0 Z+0 R0 FMAX\n2 L X+2 F10\n");
  EXPECT_EQ(geometry::end_point(p.motion_of(3)->piece), Point3(50.8, 0, 0));
  EXPECT_EQ(p.state_after(3).feed, 254);
}

TEST(KlartextMotions, NeedAUnit) {
  const KlartextProgram p("1 L X+0 Y+0 FMAX\n2 L X+2 F10\n");
  ASSERT_EQ(p.found.size(), 1U);
  EXPECT_EQ(p.found[0].id, "units-missing");
  EXPECT_NE(p.found[0].message.find("BEGIN PGM"), std::string::npos);
}

// A quarter about (10, 0), and the same circle once round.
TEST(KlartextMotions, TurnAboutTheLastCentre) {
  const KlartextProgram p =
      program_with("3 CC X+10 Y+0\n4 C X+10 Y+10 DR-\n5 C X+10 Y+10 DR+\n6 CR X+20 Y+0 R+10 DR-\n");
  const auto arc = [&](std::size_t line) { return *p.motion_of(line)->piece.arc(); };
  EXPECT_NEAR(arc(5).sweep, -std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(arc(5).center, Point3(10, 0, 0));
  EXPECT_NEAR(arc(6).sweep, 2 * std::numbers::pi, 1e-12);
  EXPECT_NEAR(arc(7).sweep, -std::numbers::pi / 2, 1e-12);
  EXPECT_LT((arc(7).center - Point3(10, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(p.line(4).kind, BlockKind::kEmpty);
}

TEST(KlartextMotions, OffTheCircleAreNotFollowed) {
  const KlartextProgram p = program_with("3 CC X+10 Y+0\n4 C X+10 Y+10.1 DR-\n");
  EXPECT_EQ(p.motion_of(5), nullptr);
  EXPECT_EQ(p.found.at(0).id, "arc-radius-mismatch");
}

// --- what is known afterwards -------------------------------------------------------------------

struct EffectCase {
  std::string lines;  // from line 4 on
  bool place_known;   // X and Y, before `L Z-1` behind them
  bool state_known;
  bool feed_known = true;
};

const EffectCase kKlartextEffectsRows[] = {

    // Harmless
    {"3 BLK FORM 0.1 Z X+0 Y+0 Z-20", true, true},
    {"3 CYCL DEF 32.0 TOLERANCE\n4 CYCL DEF 32.1 T0.02", true, true},
    {"3 CYCL DEF 200 DRILLING ~\n  Q200=+2", true, true},
    {"3 Q5 = 3\n4 FN 0: Q6 = +3", true, true},
    {"3 FN 9: IF +Q1 EQU +Q2 GOTO LBL 5", true, true},
    {"3 LBL 7", true, true},
    {"3 ; a\n4 * - b", true, true},
    {"3 M8", true, true},
    // Moves the tool
    {"3 TOOL CALL 5 Z S5000", false, true, false},
    {"3 CYCL CALL", false, true, false},
    {"3 L IX+5", false, true},
    {"3 L IX+5 F200", false, true},
    {"3 L X+5 M91", false, true},
    {"3 M140 MB MAX", false, true},
    {"3 CYCL DEF 7.0 DATUM SHIFT\n4 CYCL DEF 7.1 X+5", false, true},
    {"3 CYCL DEF 247 PRESET ~\n  Q339=+1", false, true},
    {"3 CC X+1 Y+1\n4 LP PR+5 PA+30", false, true},
    {"3 L X+Q5 Y+Q6", false, true},
    {"3 L X+5 Y+5\n4 RND R1", false, true},
    {"3 PLANE RESET STAY", false, true},
    {"3 CYCL DEF 8.0 MIRROR\n4 CYCL DEF 8.1", false, true},
    {"3 CYCL DEF 10.0 ROTATION\n4 CYCL DEF 10.1 ROT+0", false, true},
    {"3 CYCL DEF 11.0 SCALING\n4 CYCL DEF 11.1 SCL1", false, true},
    {"3 SPL X+5 Y+5 ~\n  K3X0 K2X0 K1X-5 ~\n  K3Y0 K2Y0 K1Y-5", false, true},
    {"3 L X+5 Y+5 F AUTO", false, true, false},
    // May change anything
    {"3 CALL LBL 5", false, false, false},
    {"3 CALL PGM TNC:\\A.H", false, false, false},
    {"3 LBL 5\n4 CALL LBL 5 REP 3", false, false, false},
    {"3 CYCL DEF 419 PRESET", false, false, false},
    {"3 TCH PROBE 1.0 Q5", false, false, false},
    {"3 FN 17: SYSWRITE ID5", false, false, false},
    {"3 WHATEVER", false, false, false}};

TEST(KlartextEffects, AreKnownOrForgotten) {
  for (const EffectCase& test : kKlartextEffectsRows) {
    SCOPED_TRACE(test.lines);
    const KlartextProgram p = program_with(test.lines + "\n8 L X+1 Y+1\n9 L X+2\n");
    const std::size_t last = p.program.blocks.size();
    const Motion* first = p.motion_of(last - 1);
    EXPECT_EQ(first != nullptr && first->start_known, test.place_known);
    EXPECT_EQ(is_known(p.state_after(last)), test.state_known);
    EXPECT_EQ(p.state_after(last).feed.has_value(), test.feed_known);
    EXPECT_EQ(p.state_after(last).units, Units::kMillimetre);
  }
}

// What a program says behind a statement that may have changed anything; the scale of each axis
// goes before the one of all.
const std::vector<std::string> kSafeKlartext = {
    "TOOL CALL 5 Z S5000",
    "M137",
    "M129",
    "M115",
    "M145",
    "FUNCTION RESET TCPM",
    "PLANE RESET STAY",
    "CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1",
    "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+0",
    "CYCL DEF 26.0 SCALING\nCYCL DEF 26.1 X1 Y1 Z1 CCX+0 CCY+0 CCZ+0",
    "CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL1",
    "CYCL DEF 200 DRILLING ~\n  Q200=+2",
    "L X+1 Y+1 R0 F500"};

bool is_known_behind(const std::string& statement, const std::vector<std::string>& said) {
  const KlartextProgram p = program_with("3 " + statement + "\n" +
                                         fmt::format("{}", fmt::join(said, "\n")) + "\nL X+2\n");
  return is_known(p.state_after(p.program.blocks.size()));
}

TEST(KlartextEffects, AreUndoneByTheWordsForEachAndNoFewer) {
  for (const char* statement : {"CALL PGM TNC:\\A.H", "CALL LBL 5", "WHATEVER", "TCH PROBE 1.0 Q5",
                                "CYCL DEF 419 PRESET"}) {
    SCOPED_TRACE(statement);
    EXPECT_TRUE(is_known_behind(statement, kSafeKlartext));
    for (std::size_t i = 0; i < kSafeKlartext.size(); ++i) {
      std::vector<std::string> fewer = kSafeKlartext;
      fewer.erase(fewer.begin() + static_cast<std::ptrdiff_t>(i));
      EXPECT_FALSE(is_known_behind(statement, fewer)) << "without " << kSafeKlartext[i];
    }
  }
  for (const char* on : {"M112", "M124 T0.01"}) {
    EXPECT_FALSE(is_known_behind(fmt::format("{}\n4 WHATEVER", on), kSafeKlartext)) << on;
  }
}

struct SwitchCase {
  std::string lines;
  TriState ModalState::*item;
  TriState value;
};

const SwitchCase kKlartextSwitchesRows[] = {
    {"3 L X+5 RL", &ModalState::cutter_compensation, TriState::kOn},
    {"3 L X+5 RL\n4 L X+6 R0", &ModalState::cutter_compensation, TriState::kOff},
    {"3 APPR LT X+5 Y+5 LEN5 R0", &ModalState::cutter_compensation, TriState::kOff},
    {"3 APPR LT X+5 Y+5 LEN5 RL", &ModalState::cutter_compensation, TriState::kOn},
    {"3 DEP LT LEN5", &ModalState::cutter_compensation, TriState::kUnknown},
    {"3 L X+5 M128", &ModalState::tool_center_point, TriState::kOn},
    {"3 M128\n4 M129", &ModalState::tool_center_point, TriState::kOff},
    {"3 M114\n4 M115", &ModalState::tool_center_point, TriState::kOff},
    {"3 M114\n4 M129", &ModalState::tool_center_point, TriState::kOn},
    {"3 M144\n4 M145", &ModalState::tool_center_point, TriState::kOff},
    {"3 M144\n4 M115", &ModalState::tool_center_point, TriState::kOn},
    {"3 FUNCTION TCPM F TCP", &ModalState::tool_center_point, TriState::kOn},
    {"3 FUNCTION RESET TCPM", &ModalState::tool_center_point, TriState::kOff},
    {"3 FUNCTION TCPM F TCP\n4 M129", &ModalState::tool_center_point, TriState::kOn},
    {"3 FUNCTION TCPM F TCP\n4 FUNCTION RESET TCPM", &ModalState::tool_center_point,
     TriState::kOff},
    {"3 M128\n4 FUNCTION RESET TCPM", &ModalState::tool_center_point, TriState::kOn},
    {"3 /FUNCTION TCPM F TCP\n4 M129", &ModalState::tool_center_point, TriState::kUnknown},
    {"3 /M128\n4 FUNCTION RESET TCPM", &ModalState::tool_center_point, TriState::kUnknown},
    {"3 M128\n4 FUNCTION TCPM F TCP\n5 M129\n6 FUNCTION RESET TCPM", &ModalState::tool_center_point,
     TriState::kOff},
    {"3 PLANE SPATIAL SPA+0 SPB+30 SPC+0 MOVE", &ModalState::tilted_plane, TriState::kOn},
    {"3 CYCL DEF 19.0 W\n4 CYCL DEF 19.1 A+0 B+5", &ModalState::tilted_plane, TriState::kOn},
    {"3 CYCL DEF 19.1 A+1\n4 CYCL DEF 19.0 W\n5 CYCL DEF 19.1", &ModalState::tilted_plane,
     TriState::kOff},
    {"3 CYCL DEF 8.0 MIRROR\n4 CYCL DEF 8.1 X", &ModalState::mirror, TriState::kOn},
    {"3 CYCL DEF 10.1 ROT+30", &ModalState::rotation, TriState::kOn},
    {"3 CYCL DEF 10.1 IROT+0", &ModalState::rotation, TriState::kOn},
    {"3 CYCL DEF 11.1 SCL 0.5", &ModalState::scaling, TriState::kOn},
    {"3 CYCL DEF 26.1 X0.5\n4 CYCL DEF 11.1 SCL 1", &ModalState::scaling, TriState::kUnknown},
    {"3 CYCL DEF 26.1 X0.5\n4 CYCL DEF 26.1 X1 Y1\n5 CYCL DEF 11.1 SCL 1", &ModalState::scaling,
     TriState::kUnknown},
    {"3 CYCL DEF 26.1 X0.5\n4 CYCL DEF 11.1 SCL 1\n5 CYCL DEF 26.1 X1 Y1 Z1", &ModalState::scaling,
     TriState::kUnknown},
    {"3 CYCL DEF 26.1 X0.5\n4 CYCL DEF 26.1 X 1 Y 1 Z 1\n5 CYCL DEF 11.1 SCL 1",
     &ModalState::scaling, TriState::kOff},
    {"3 L X+5 M89", &ModalState::modal_macro, TriState::kOn},
    {"3 L X+5 M89\n4 CYCL DEF 200 DRILLING ~\n  Q200=+2", &ModalState::modal_macro, TriState::kOff},
    {"3 M124 T0.01", &ModalState::control_smoothing, TriState::kOn}};

TEST(KlartextSwitches, AreFollowed) {
  for (const SwitchCase& test : kKlartextSwitchesRows) {
    SCOPED_TRACE(test.lines);
    const KlartextProgram p = program_with(test.lines);
    EXPECT_EQ(p.state_after(p.program.blocks.size()).*test.item, test.value);
  }
}

// A feed in a comment of a spline's lines is none.
TEST(KlartextEffects, CommentsAreNotRead) {
  const KlartextProgram p =
      program_with("3 SPL X+5 Y+5 ~\n  K3X0 K2X0 K1X-5 ; F900 RL\n4 L X+9 Y+1\n");
  EXPECT_EQ(p.state_after(6).feed, 500);
  EXPECT_EQ(p.state_after(6).cutter_compensation, TriState::kOff);
}

// Which lines of these are bodies.
std::string bodies_in(const std::string& lines) {
  std::string found;
  for (const BlockFlow& each :
       follow_flow(KlartextProgram(lines).program, Returns::kBehindCalls).blocks) {
    found += each.jump_target ? 'T' : each.in_body ? 'b' : '.';
  }
  return found;
}

TEST(KlartextFlow, BodiesReachFromTheLabelToItsEndOrItsLastCall) {
  EXPECT_EQ(bodies_in("L X1\nLBL 1\nL X2\nLBL 0\nL X3\nCALL LBL 1\nL X4\n"), ".Tbbbb.");
  EXPECT_EQ(bodies_in("LBL 1\nL X2\nCALL LBL 1 REP 5\nL X4\n"), "Tbb.");
  EXPECT_EQ(bodies_in("CALL LBL 1\nL X1\nLBL 1\nL X2\nLBL 0\nL X3\n"), "..Tbb.");
  EXPECT_EQ(bodies_in("LBL \"A\"\nL X2\nFN 9: IF +Q1 EQU +Q2 GOTO LBL \"A\"\nL X4\n"), "Tbb.");
  EXPECT_EQ(bodies_in("LBL 1\nL X2\nCALL LBL Q5\nL X4\n"), "Tbb.");
}

TEST(KlartextFlow, LabelsThatNothingNamesAreNone) {
  EXPECT_EQ(bodies_in("LBL 1\nL X2\nCALL LBL 2\nLBL 0\nL X4\n"), ".....");
}

// The golden curve of fanuc_curves.md: where it ends is (40, 0).
TEST(KlartextCurves, AreMotionsWhereTheControlReadsThem) {
  const std::string text =
      "0 BEGIN PGM PART MM\n7 L X+0 Y+0 Z+0 R0 F3000\n8 SPL X+18 Y+6.4 ~\n"
      "  K3X-6 K2X+0 K1X-1.2E+001 ~\n  K3Y+5.6 K2Y-4.8 K1Y-7.2 F3000\n9 SPL X+40 Y+0 ~\n"
      "  K3X-4 K2X+1.2E+001 K1X-3E+001 ~\n  K3Y+6.4 K2Y-3E+001 K1Y+3E+001\n10 L X+50\n";
  const KlartextProgram read(text, &heidenhain_spl());
  EXPECT_EQ(read.motion_of(3)->kind, MotionKind::kCurve);
  EXPECT_TRUE(read.line(4).of_curve);
  EXPECT_EQ(geometry::end_point(read.motion_of(6)->piece), Point3(40, 0, 0));
  EXPECT_EQ(geometry::start_point(read.motion_of(9)->piece), Point3(40, 0, 0));
  const KlartextProgram opaque(text);
  EXPECT_EQ(opaque.motion_of(3), nullptr);
  EXPECT_EQ(opaque.line(3).barrier, reason::kSpline);
  EXPECT_FALSE(opaque.motion_of(9)->start_known);
}

}  // namespace
}  // namespace batten::gcode
