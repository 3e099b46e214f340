// What cannot be converted: each block with its place, and nothing is written.
#include <gtest/gtest.h>

#include "tests/support/conversion_programs.h"

namespace batten::postproc {
namespace {

struct WayRefused {
  const char* name;
  const char* blocks;
  std::string told;  // place and message, without the target, one to a line
};

void expect_refused(const std::string& text, const char* target, const WayRefused& refused) {
  const SmoothResult result = smoothed(text, ways_to(target));
  EXPECT_FALSE(result.understood) << refused.name;
  EXPECT_EQ(result.text, "") << refused.name;
  std::vector<std::string> expected;
  for (const std::string& each : lines_of(refused.told)) {
    expected.push_back(fmt::format("{} (target {})", each, target));
  }
  EXPECT_EQ(told(result, text), expected) << refused.name;
}

// The blocks begin in line 3, behind two that are certain; the columns count the block number.
TEST(ConversionWays, ListTheBlocksOfKlartextThatCannotBeSaid) {
  const WayRefused kRefused[] = {
      {"Compensation", "L X+1 RL F500\nL X+2 R0\n",
       "3:9: RL moves beside the path by the radius of the tool"},
      {"Increment", "L IX+5 F500\nL X+0 Y+0 F500\n",
       "3:1: 2 L IX+5 F500 is no block of plain words"},
      {"Parameter", "Q1 = +5\nL X+Q1 F500\nL X+0 F500\n",
       "3:1: 2 Q1 = +5 is no block of plain words"},
      {"UnknownParameter", "L X+Q1 F500\nL X+0 F500\n",
       "3:1: 2 L X+Q1 F500 is no block of plain words"},
      {"Cycle", "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nL X+0 Y+0 Z+1 FMAX\n",
       "3:1: 2 CYCL DEF 7.0 DATUM SHIFT is no block of plain words\n"
       "4:1: 3 CYCL DEF 7.1 X+10 is no block of plain words"},
      {"Tangential", "L X+5 F500\nCT X+10 Y+10\nL X+0 Y+0 FMAX\n",
       "3:1: 2 L X+5 F500 is no block of plain words\n"
       "4:1: 3 CT X+10 Y+10 is no block of plain words"},
      {"Polar", "CC X+0 Y+0\nLP PR+10 PA+30 F500\nL X+0 Y+0 FMAX\n",
       "4:1: 3 LP PR+10 PA+30 F500 is no block of plain words"},
      {"Label", "LBL 1\nCALL LBL 1 REP 2\nL X+0 Y+0 Z+1 FMAX\n",
       "3:1: 2 LBL 1 is no block of plain words\n"
       "4:1: 3 CALL LBL 1 REP 2 is no block of plain words\n"
       "5:1: 4 L X+0 Y+0 Z+1 FMAX is not understood"},
      {"ToolDef", "TOOL DEF 5 L+0 R+3\n", "3:1: 2 TOOL DEF 5 L+0 R+3 is no block of plain words"},
      {"ToolByName", "TOOL CALL \"MILL\" Z S1000\nL X+0 FMAX\n",
       "3:1: 2 TOOL CALL \"MILL\" Z S1000 is no block of plain words"},
      {"Oversize", "TOOL CALL 5 Z S1000 DL+0.1\nL X+0 FMAX\n",
       "3:1: 2 TOOL CALL 5 Z S1000 DL+0.1 is no block of plain words"},
      {"OtherToolAxis", "TOOL CALL 5 Y S1000\nL X+0 FMAX\n",
       "3:1: 2 TOOL CALL 5 Y S1000 is no block of plain words"},
      {"Function", "M7\n", "3:3: M7 may mean something else there"},
      {"FunctionInMotion", "L X+1 FMAX M99\nL X+0 FMAX\n",
       "3:1: 2 L X+1 FMAX M99 is no block of plain words"},
      {"OtherAxis", "L X+1 A+5 F500\nL X+0 Y+0 Z+1 FMAX\n",
       "3:9: A+5 may mean something else there"},
      {"StopWithSpindleOn", "M3\nM0\n",
       "4:3: M0 stops spindle and coolant on some controls, and they may be on"},
      {"FeedOfTheTool", "TOOL CALL 1 Z F500\nL X+1\n",
       "4:1: 3 L X+1 moves at a feed that is not known"},
      {"Tilted", "PLANE SPATIAL SPA+0 SPB+45 SPC+0 STAY\nPLANE RESET STAY\nL X+0 Y+0 Z+1 FMAX\n",
       "3:1: 2 PLANE SPATIAL SPA+0 SPB+45 SPC+0 STAY is no block of plain words"},
      {"NoFeed", "TOOL CALL 1 Z\nL X+1\n", "4:1: 3 L X+1 moves at a feed that is not known"},
      {"SplineBlock", "SPL X+1 ~\n  K3X+0 K2X+0 K1X-1 F500\nL X+0 Y+0 Z+1 FMAX\n",
       "3:1: 2 SPL X+1 ~ is no block of plain words\n"
       "4:1:   K3X+0 K2X+0 K1X-1 F500 is no block of plain words"},
  };
  for (const WayRefused& refused : kRefused) {
    const std::string text =
        as_klartext("L X+0 Y+0 Z+5 R0 FMAX\n" + std::string(refused.blocks) + "M30\n");
    expect_refused(text, "linuxcnc", refused);
    expect_refused(text, "siemens", refused);
  }
}

// What posts write at the beginning to be safe does nothing there.
TEST(ConversionWays, LeaveOutEndsOfWhatNeverBegan) {
  const std::string klartext = as_klartext(
      "PLANE RESET STAY\nTOOL CALL 5 Z S3000 F800\nM3\nL X+0 Y+0 FMAX\nL Z+5 FMAX\nL X+1 "
      "F100\nM30\n");
  const std::string siemens =
      "%_N_TEST_MPF\nG710\nTRAFOOF\nCOMPOF\nDIAMOF\nG17 G40 G90 G94\nT5 M6\nD1\nS3000 M3\n"
      "G0 X0 Y0\nZ5\nG1 X1 F100\nM30\n";
  for (const std::string& text : {klartext, siemens}) {
    EXPECT_EQ(proved_text(text, "linuxcnc"),
              "G21 G17 G40 G90 G94\nT5 M6\nG43 H5\nS3000 M3\nG0 X0 Y0\nZ5\nG1 X1 F100\nM30\n");
  }
}

TEST(ConversionWays, ListTheBlocksOfSiemensProgramsThatCannotBeSaid) {
  const WayRefused kRefused[] = {
      {"Frame", "TRANS X10\nG0 X0 Y0 Z5\n", "5:1: TRANS is a word that only Siemens controls have"},
      {"Compressor", "COMPCAD\nCOMPOF\n", "5:1: COMPCAD is a word that only Siemens controls have"},
      {"Message", "MSG(\"hello\")\n",
       "5:1: MSG(\"hello\") is a word that only Siemens controls have"},
      {"Cycle", "CYCLE832(0.01,1,1)\n",
       "5:1: CYCLE832(0.01,1,1) is a word that only Siemens controls have"},
      {"Parameter", "R1=5\nX=R1\nX0\n", "5:1: R1=5 is no block of plain words"},
      {"UnknownParameter", "X=R1\nX0\n", "5:1: X=R1 is no block of plain words"},
      {"Increment", "X=IC(5)\nX0\n", "5:1: X=IC(5) is no block of plain words"},
      {"Offset", "G505\nG0 X0 Y0 Z5\n", "5:1: G505 is a word that only Siemens controls have"},
      {"InchPlacesAlone", "G70\nG0 X0 Y0 Z1\n", "5:1: G70 leaves feeds in millimetres"},
      {"ExactStop", "G60\nG64\n", "5:1: G60 may mean something else there"},
      {"ToolByName", "T=\"MILL\"\nM6\nG0 X0 Y0 Z5\n",
       "5:1: T=\"MILL\" is no block of plain words\n"
       "6:1: M6 names no tool"},
      {"OtherEdge", "T1 M6\nD2\nG0 X0 Y0\n", "6:1: D2 is another edge of the tool"},
      {"EdgeOfNoTool", "D1\nG0 X0 Y0 Z5\n",
       "5:1: D1 names the length of a tool that no M6 has put in"},
      {"EdgeTooLate", "T1 M6\nG0 Z5\nD1\nG0 X0 Y0 Z5\n",
       "7:1: D1 comes after a motion without the length of the tool"},
      {"Jump", "GOTOF ENDE\nENDE:\n",
       "5:1: GOTOF ENDE is no block of plain words\n"
       "6:1: ENDE: is jumped to"},
      {"Subprogram", "L100\nG0 X0 Y0 Z5\n",
       "5:1: L100 is no block of plain words\n"
       "6:1: G0 X0 Y0 Z5 is not understood"},
      {"Helix", "G2 X2 Y0 Z4 I1 J0 F100\nG0 X0\n", "5:1: G2 X2 Y0 Z4 I1 J0 F100 is a helix"},
      {"Skipped", "/G0 X3\nG0 X0 Y0 Z5\n",
       "5:1: /G0 X3 is left out by some controls, run by others"},
      {"SpindleStopInMotion", "G0 X5 M5\n",
       "5:7: M5 acts before or after the motion of its block: controls differ"},
      {"Turns", "G4 S20\n", "5:1: G4 S20 waits for turns of the spindle, which is no time"},
  };
  for (const WayRefused& refused : kRefused) {
    const std::string text = "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\nG0 X0 Y0 Z5\n" +
                             std::string(refused.blocks) + "M30\n";
    if (std::string_view(refused.name) != "EdgeTooLate") expect_refused(text, "linuxcnc", refused);
    expect_refused(text, "heidenhain", refused);
  }
}

// Whole programs, and words that a target has not: found by the acts that need them.
TEST(ConversionWays, ListWhatATargetHasNoWordFor) {
  struct Row {
    const char* target;
    std::string text;
    const char* told;
  };
  const std::string tool = as_klartext("TOOL CALL 5 Z S3000\nL X+0 Y+0 Z+5 R0 FMAX\nM3\nM5\nM30\n");
  const std::string moves = as_klartext("L X+0 Y+0 Z+5 R0 FMAX\nM30\n");
  const Row rows[] = {
      {"linuxcnc", "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\nG0 X0 Y0 Z5\n",
       "4:1: G0 X0 Y0 Z5 ends the program without M2 or M30"},
      {"fanuc", replaced(moves, " MM", " INCH"),
       "1:1: 0 BEGIN PGM TEST INCH is in inches, where it is not certain what F means"},
      {"fanuc", as_klartext("M3\nL X+0 Y+0 Z+5 R0 FMAX\n"),
       "4:1: 3 END PGM TEST MM ends without M2 or M30, and spindle or coolant may be on"},
      {"grbl", tool, "2:1: 1 TOOL CALL 5 Z S3000 needs M6, which is not taken there"},
      {"okuma", tool, "2:1: 1 TOOL CALL 5 Z S3000 needs G43, which is not taken there"},
      {"okuma", as_klartext("; G55: its datum is active\nL X+0 Y+0 Z+5 R0 FMAX\nM30\n"),
       "2:3: ; G55: its datum is active needs G55, which is not taken there"},
      {"fagor", moves,
       "2:1: 1 L X+0 Y+0 Z+5 R0 FMAX needs G21: no millimetre word on Fagor, whose units are G70 "
       "and "
       "G71"}};
  for (const Row& row : rows) expect_refused(row.text, row.target, {row.told, "", row.told});
}

}  // namespace
}  // namespace batten::postproc
