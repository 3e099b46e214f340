// The verifier on wrong outputs, each of which it must find, and on good ones, which it must
// accept. Programs are written by hand; each wrong one differs from a good one in one thing.
#include "postproc/proof/verification.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

Verification verified(const std::string& before, const std::string& after) {
  return verdict(before, after, 0.01);
}

std::string all_violations(const Verification& found) {
  std::string text;
  for (const Violation& violation : found.violations) {
    text += violation.id + " old " + std::to_string(violation.old_line) + " new " +
            std::to_string(violation.new_line) + ": " + violation.message + "\n";
  }
  return text;
}

bool has_violation(const Verification& found, std::string_view id) {
  return std::ranges::any_of(found.violations, [id](const Violation& b) { return b.id == id; });
}

// Two runs with a rapid between, coolant, a feed change inside the first run.
const std::string kProgram =
    "%\n"                    // 1
    "(a part)\n"             // 2
    "G21 G90 G17 G40 G49\n"  // 3
    "T1 M6\n"                // 4
    "S12000 M3\n"            // 5
    "G0 X0 Y0 Z5\n"          // 6
    "M8\n"                   // 7
    "G1 Z-1 F300\n"          // 8
    "G1 X10 Y0 F1000\n"      // 9
    "X20 Y0.002\n"           // 10
    "X30 Y0\n"               // 11
    "X30 Y10\n"              // 12
    "X30 Y20 F800\n"         // 13
    "X20 Y20\n"              // 14
    "G0 Z5\n"                // 15
    "X50 Y50\n"              // 16
    "G1 Z-1 F300\n"          // 17
    "G1 X60 Y50 F1000\n"     // 18
    "X60 Y60\n"              // 19
    "M9\n"                   // 20
    "G0 Z5\n"                // 21
    "M5\n"                   // 22
    "M30\n"                  // 23
    "%\n";                   // 24

// --- what is wrong --------------------------------------------------------------------------

struct WrongCase {
  std::string name;
  std::string before;
  std::string after;
  std::string id;              // that the violation must have
  std::uint32_t old_line = 0;  // 0: not asked
  std::uint32_t new_line = 0;
};

// X of the cuts of the first run moved by 0.011 mm.
std::string shifted_program() {
  std::string text = kProgram;
  for (const std::string number :
       {"X10 Y0 F", "X20 Y0.", "X30 Y0\n", "X30 Y10", "X30 Y20", "X20 Y20"}) {
    text = replaced(text, number, number.substr(0, 3) + ".011" + number.substr(3));
  }
  return text;
}

std::vector<WrongCase> wrong_cases() {
  const auto but = [](std::string_view what, std::string_view by) {
    return replaced(kProgram, what, by);
  };
  // Zig-zag along one line: as a set of places nothing is missing.
  const std::string zigzag = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F500\nX2\nX12\nX12 Y5\nG0 Z5\nM30\n";
  const std::string arcs = "G21 G90 G17\nG0 X0 Y0 Z0\nG1 X10 F500\nG2 X20 Y0 I5 J0\nG0 Z5\nM30\n";
  const std::string messages =
      "G21 G90\nG0 X0 Y0 Z0\n(MSG, one)\nG1 X10 F500\n(MSG, two)\nG1 X20\nM30\n";
  const std::string dense = "G21 G90\nG0 X0 Y0 Z0\nG1 X1 F500\nX2\nX3\nX4\nM62 \nX5\nX6\nX7\nM30\n";
  const std::string comp =
      "G21 G90 G17\nT1\nG0 X0 Y0 Z0\nG41 D1\nG1 X10 F500\nX20 Y0.001\nX30\nG40\nG1 X40\nM30\n";
  const std::string parameters = "G21 G90\nG0 X0 Y0 Z0\n#1 = 5\nG1 X10 F500\nX[#1]\nM30\n";
  const std::string blending = "G21 G90\nG64 P0.01\nG0 X0 Y0 Z0\nG1 X5 F100\nG64\nG1 X9\nM30\n";
  const std::string lengths = "G21 G90\nT1 M6\nG43 H1\nG0 X0 Y0 Z0\nT2 M6\nG43\nG0 X0 Y0 Z0\nM30\n";
  const std::string offsets = "G21 G90\nG0 X0 Y0 Z0\nG54 P2\nG0 X0 Y0 Z0\nG54\nG0 X0 Y0 Z0\nM30\n";
  const std::string rotary = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 A5 F500\nX20 A10\nM30\n";
  return {
      {"ShiftByElevenTenthsOfTheTolerance", kProgram, shifted_program(), "distance"},
      {"CutCorner", kProgram, but("X30 Y0\n", "X29.9 Y0\nX30 Y0.1\n"), "distance"},
      {"DroppedCornerBlock", kProgram, but("X30 Y0\n", ""), "distance"},
      {"DroppedLastBlockOfARun", kProgram, but("X20 Y20\n", ""), "distance"},
      {"AddedBlock", kProgram, but("X30 Y10\n", "X30 Y10\nX31 Y10\nX30 Y10\n"), "distance", 0, 13},
      {"MovedEndOfARunAndTheRapidAfterIt", kProgram, but("X20 Y20\n", "X20.011 Y20\n"), "distance",
       14, 14},
      {"LostCoolant", kProgram, but("M8\n", ""), "event-lost", 7, 0},
      {"LostCoolantOff", kProgram, but("M9\n", ""), "event-lost", 20, 0},
      {"AddedCoolant", kProgram, but("X30 Y10\n", "X30 Y10\nM7\n"), "event-added", 0, 13},
      {"CoolantMovedBehindACut", kProgram, but("M8\nG1 Z-1 F300\n", "G1 Z-1 F300\nM8\n"),
       "event-moved", 7, 8},
      {"CoolantMovedPastARapid", kProgram,
       replaced(but("M8\n", ""), "G0 X0 Y0 Z5\n", "M8\nG0 X0 Y0 Z5\n"), "event-moved"},
      {"CoolantInTheBlockOfTheCut", kProgram, but("M8\nG1 Z-1", "G1 Z-1 M8"), "event-lost", 7, 0},
      {"OtherSpindleSpeed", kProgram, but("S12000", "S1200"), "event-changed", 5, 5},
      {"OtherSpindleDirection", kProgram, but("M3", "M4"), "event-changed", 5, 5},
      {"OtherTool", kProgram, but("T1", "T2"), "event-changed", 4, 4},
      {"OtherFeed", kProgram, but("F800", "F801"), "feed-changed", 13, 13},
      {"LostFeed", kProgram, but(" F800", ""), "feed-changed", 13, 0},
      {"FeedOneBlockLater", kProgram, but("X30 Y20 F800\nX20 Y20\n", "X30 Y20\nX20 Y20 F800\n"),
       "feed-moved"},
      {"FeedTwoHundredthsLater", kProgram,
       but("X30 Y10\nX30 Y20 F800\n", "X30 Y10.02\nX30 Y20 F800\n"), "feed-moved"},
      {"OtherRapid", kProgram, but("X50 Y50\n", "X50 Y50.001\n"), "rapid-changed", 16, 16},
      {"LowerRapid", kProgram, but("G0 Z5\nX50", "G0 Z4\nX50"), "rapid-changed", 15, 15},
      {"LostRapid", kProgram, but("G0 Z5\nX50 Y50\n", "G0 X50 Y50\n"), "rapid-lost", 15, 0},
      {"RapidAsACut", kProgram, but("G0 Z5\nX50", "G1 Z5\nG0 X50"), "rapid-lost", 15, 0},
      {"SwappedRapids", kProgram, but("G0 Z5\nX50 Y50\n", "G0 X50 Y50\nZ5\n"), "rapid-changed", 15,
       15},
      {"SwappedRuns", kProgram,
       "%\n(a part)\nG21 G90 G17 G40 G49\nT1 M6\nS12000 M3\nG0 X0 Y0 Z5\nM8\nG0 X50 Y50\n"
       "G1 Z-1 F300\nG1 X60 Y50 F1000\nX60 Y60\nG0 Z5\nX0 Y0\nG1 Z-1 F300\nG1 X10 Y0 F1000\n"
       "X20 Y0.002\nX30 Y0\nX30 Y10\nX30 Y20 F800\nX20 Y20\nM9\nG0 Z5\nM5\nM30\n%\n",
       "rapid-added"},
      {"ShortenedZigZag", zigzag, replaced(zigzag, "X10 F500\nX2\nX12\n", "X12 F500\n"),
       "distance"},
      {"ArcTheOtherWayRound", arcs, replaced(arcs, "G2 ", "G3 "), "distance", 4, 4},
      {"ArcInAnotherPlane", arcs, replaced(arcs, "G17", "G18"), "state-changed"},
      // A stop comes when the rest of its block is done.
      {"StopInTheBlockOfAnOffset", "G21 G90\nG54\nG0 X0 Y0 Z0\nG1 X5 F100\nM1\nG55\nG0 X9\nM30\n",
       "G21 G90\nG54\nG0 X0 Y0 Z0\nG1 X5 F100\nM1 G55\nG0 X9\nM30\n", "event-changed", 5, 5},
      {"LostUnits", kProgram, but("G21 ", ""), "event-lost", 3, 0},
      {"Inches", kProgram, but("G21", "G20"), "event-changed", 3, 3},
      {"LostAbsolute", kProgram, but("G90 ", ""), "event-lost", 3, 0},
      {"LostPlaneWord", kProgram, but("G17 ", ""), "state-changed"},
      {"LostCompensationOff", kProgram, but("G40 ", ""), "event-lost", 3, 0},
      {"LostProgramEnd", kProgram, but("M30\n", ""), "event-lost", 23, 0},
      {"LostProgramMark", kProgram, but("%\n(a part)", "(a part)"), "event-lost", 1, 0},
      {"SwappedMessages", messages,
       "G21 G90\nG0 X0 Y0 Z0\n(MSG, two)\nG1 X10 F500\n(MSG, one)\nG1 X20\nM30\n", "event-changed",
       3, 3},
      {"LostMessage", messages, replaced(messages, "(MSG, two)\n", ""), "event-lost", 5, 0},
      // It comes before the motion of its block.
      {"MessageInTheBlockOfAMove", messages,
       replaced(messages, "G1 X10 F500\n(MSG, two)", "G1 X10 F500 (MSG, two)"), "event-moved", 5,
       4},
      {"SignalOneBlockLater", dense, replaced(dense, "M62 \nX5\n", "X5\nM62 \n"), "event-moved", 7,
       8},
      {"SmoothedUnderCutterCompensation", comp, replaced(comp, "X20 Y0.001\n", ""), "event-lost", 6,
       0},
      // X[#1] is a number no more.
      {"LostAssignment", parameters, replaced(parameters, "#1 = 5\n", ""), "event-changed", 3, 4},
      {"OtherAssignment", parameters, replaced(parameters, "#1 = 5", "#1 = 6"), "event-changed", 3,
       3},
      {"OtherBlanksInAnOpaqueBlock", parameters, replaced(parameters, "#1 = 5", "#1=5"),
       "event-changed", 3, 3},
      {"OtherExpression", parameters, replaced(parameters, "X[#1]", "X[#2]"), "event-added", 0, 5},
      {"OtherRotaryAngle", rotary, replaced(rotary, "A10", "A10.5"), "event-changed", 4, 4},
      {"DroppedRotaryBlock", rotary, replaced(rotary, "X20 A10\n", ""), "event-lost", 4, 0},
      {"LostDwell", "G21 G90\nG0 X0 Y0 Z0\nG1 X5 F100\nG4 P1.5\nG1 X9\nM30\n",
       "G21 G90\nG0 X0 Y0 Z0\nG1 X5 F100\nG1 X9\nM30\n", "event-lost", 4, 0},
      {"OtherDwell", "G21 G90\nG0 X0 Y0 Z0\nG1 X5 F100\nG4 P1.5\nM30\n",
       "G21 G90\nG0 X0 Y0 Z0\nG1 X5 F100\nG4 P15\nM30\n", "event-changed", 4, 4},
      {"LostLabelThatIsReferredTo", "G21 G90\nG0 X0 Y0 Z0\nN10 G1 X5 F100\nG1 X9\nGOTO 10\nM30\n",
       "G21 G90\nG0 X0 Y0 Z0\nG1 X5 F100\nG1 X9\nGOTO 10\nM30\n", "event-lost", 3, 0},
      {"BlendingChanged", "G21 G90 G64\nG0 X0 Y0 Z0\nG1 X5 F100\nM30\n",
       "G21 G90 G61\nG0 X0 Y0 Z0\nG1 X5 F100\nM30\n", "event-changed", 1, 1},
      {"LostEndOfABlendingTolerance", blending, replaced(blending, "G64\n", ""), "event-lost", 5,
       0},
      {"AddedEndOfABlendingTolerance", replaced(blending, "G64\n", ""), blending, "event-added", 0,
       5},
      {"LostBlendingThatWasSetBefore", replaced(blending, "G64 P0.01", "G64"),
       replaced(replaced(blending, "G64 P0.01", "G64"), "G1 X5 F100\nG64\n", "G1 X5 F100\n"),
       "event-lost", 5, 0},
      {"LostLengthOfTheNextTool", lengths, replaced(lengths, "G43\n", ""), "event-lost", 6, 0},
      {"LostWorkOffsetBehindAFurtherOne", offsets, replaced(offsets, "G54\n", ""), "event-lost", 5,
       0},
      {"ArcToNowhere", kProgram, but("X20 Y20\n", "X20 Y20\nG2\n"), "event-added", 0, 15},
      {"CutToNowhereBeforeTheFirstFeed", kProgram, but("S12000 M3\n", "S12000 M3\nG1\n"),
       "event-added", 0, 6},
      {"NumberBehindWords", kProgram, but("X20 Y20\n", "X20 Y20 N5\n"), "event-added", 0, 14},
      {"NumberWithASign", kProgram, but("X20 Y20\n", "N-1 X20 Y20\n"), "event-added", 0, 14},
      {"NumberBehindAComment", kProgram, but("X20 Y20\n", "(a) N5 X20 Y20\n"), "event-added", 0,
       14},
      {"OpenComment", kProgram, but("X20 Y20\n", "X20 Y20 (a\n"), "event-added", 0, 14},
      {"NestedComment", kProgram, but("X20 Y20\n", "X20 Y20\n(a (b)\n"), "event-added", 0, 15},
      {"NumberBehindWordsOfACopiedBlock", rotary, replaced(rotary, "X20 A10", "X20 A10 N5"),
       "event-changed", 4, 4},
      {"FeedOfARapid", kProgram, but("X50 Y50\n", "X50 Y50 F90\n"), "state-changed", 16, 16},
      {"FeedBehindTheLastMotion", kProgram, but("M9\n", "F90\nM9\n"), "state-changed", 20, 21},
      {"DrilledElsewhere", "G21 G90\nG0 X0 Y0 Z5\nG81 X1 Y1 Z-3 R1 F50\nX2\nG80\nM30\n",
       "G21 G90\nG0 X0 Y0 Z5\nG81 X1 Y1 Z-3 R1 F50\nX2.5\nG80\nM30\n", "event-changed", 4, 4},
      {"NothingLeft", kProgram, "%\n%\n", "event-lost"},
  };
}

TEST(Refuses, WhatDoesSomethingElse) {
  for (const WrongCase& test : wrong_cases()) {
    SCOPED_TRACE(test.name);
    const Verification found = verified(test.before, test.after);
    EXPECT_FALSE(found.proved());
    const auto violation = std::ranges::find(found.violations, test.id, &Violation::id);
    ASSERT_NE(violation, found.violations.end()) << all_violations(found);
    const auto is_line = [](std::uint32_t line, std::uint32_t asked) {
      return asked == 0 || line == asked;
    };
    EXPECT_TRUE(is_line(violation->old_line, test.old_line)) << all_violations(found);
    EXPECT_TRUE(is_line(violation->new_line, test.new_line)) << all_violations(found);
    EXPECT_FALSE(violation->message.empty());
  }
}

// --- what is right --------------------------------------------------------------------------

struct GoodCase {
  std::string name;
  std::string before;
  std::string after;
};

// A quarter of a circle of radius 10 in 64 chords: sagitta 0.0008 mm.
std::string chords(const char* format) {
  std::string text;
  for (int k = 1; k <= 64; ++k) {
    const double angle = std::numbers::pi / 2 * k / 64;
    text += fmt::format(fmt::runtime(format), 10 * std::cos(angle), 10 * std::sin(angle));
  }
  return text;
}

std::vector<GoodCase> good_cases() {
  const auto but = [](std::string_view what, std::string_view by) {
    return replaced(kProgram, what, by);
  };
  const std::string in_chords = "G21 G90 G17\nG0 X10 Y0 Z0\nG1 Z-1 F100\n" +
                                chords("G1 X{:.4f} Y{:.4f} F500\n") + "G0 Z5\nM30\n";
  const std::string arc =
      "G21 G90 G17\nG0 X10 Y0 Z0\nG1 Z-1 F100\nG3 X0 Y10 I-10 J0 F500\nG0 Z5\nM30\n";
  const std::string side_chords =
      "G21 G90 G17\nG0 X10 Y0 Z0\nG1 X10 F500\n" + chords("X{:.4f} Z{:.4f}\n") + "X-5\nM9\nM30\n";
  const std::string side_arc =
      "G21 G90 G17\nG0 X10 Y0 Z0\nG1 X10 F500\nG18 G2 X0 Z10 I-10 K0\nG17 G1 X-5\nM9\nM30\n";
  return {
      {"TheSameText", kProgram, kProgram},
      {"PathMovedByAlmostTheTolerance", kProgram, but("X30 Y0\n", "X30.006 Y-0.0079\n")},
      {"MergedLines", kProgram, but("G1 X10 Y0 F1000\nX20 Y0.002\nX30 Y0\n", "G1 X30 Y0 F1000\n")},
      {"ArcForChords", in_chords, arc},
      {"ChordsForAnArc", arc, in_chords},
      {"PlaneChangedAndRestored", side_chords, side_arc},
      {"RepeatedWordsDropped",
       "G21 G90\nG0 X0 Y0 Z0\nS100 M3\nG90 G1 X1 F500 S100\nG90 G1 X2 F500 S100\nG90 G1 X3 F500 "
       "S100\nM30\n",
       "G21 G90\nG0 X0 Y0 Z0\nS100 M3\nG90 G1 X1 F500 S100\nX3\nM30\n"},
      {"LineNumbersDropped", "N1 G21 G90\nN2 G0 X0 Y0 Z0\nN3 G1 X1 F500\nN4 X2\nN5 X3\nN6 M30\n",
       "N1 G21 G90\nN2 G0 X0 Y0 Z0\nG1 X3 F500\nN6 M30\n"},
      {"CommentsDropped", kProgram, but("(a part)\n", "")},
      {"PlainCommentsMoved", "G21 G90\n(one)\nG0 X0 Y0 Z0\nG1 X1 F5\nM30\n",
       "G21 G90\nG0 X0 Y0 Z0\nG1 X1 F5 ; one\nM30\n"},
      {"CopiedOpaqueBlocks", "G21 G90\n#1 = 5\nG0 X0 Y0 Z0\nO100 sub\nG1 X1 F5\nO100 endsub\nM30\n",
       "G21 G90\n#1 = 5\nG0 X0 Y0 Z0\nO100 sub\nG1 X1 F5\nO100 endsub\nM30\n"},
      {"FeedChangeKeptAtItsPlace", kProgram,
       but("X30 Y0\nX30 Y10\nX30 Y20 F800\nX20 Y20\n",
           "X30 Y0\nX30 Y5\nX30 Y9.995\nX30 Y20 F800\nX20 Y20\n")},
      {"FeedOfABlockThatDoesNotMove", "G21 G90\nG0 X0 Y0 Z0\nG1 X1 F500\nX1 F300\nX2 F500\nM30\n",
       "G21 G90\nG0 X0 Y0 Z0\nG1 X2 F500\nM30\n"},
      {"InchesMerged", "G20 G90\nG0 X0 Y0 Z0\nG1 X.1 Y.1 F10\nX.2 Y.2\nX.3 Y.3\nM30\n",
       "G20 G90\nG0 X0 Y0 Z0\nG1 X.3 Y.3 F10\nM30\n"},
      {"OtherLineEndsAndBlanks", "G21 G90\nG0 X0 Y0 Z0\nG1 X1 F500\nM30\n",
       "G21G90\r\nG0X0Y0Z0\r\nG1 X1.000 F500.\r\nM30\r\n"},
  };
}

TEST(Accepts, WhatDoesTheSame) {
  for (const GoodCase& test : good_cases()) {
    SCOPED_TRACE(test.name);
    const Verification found = verified(test.before, test.after);
    EXPECT_TRUE(found.proved()) << all_violations(found);
    EXPECT_LE(found.deviation_mm, 0.01);
    EXPECT_GT(found.events_compared, 0U);
  }
}

// --- what it tells --------------------------------------------------------------------------

// LinuxCNC forgets the feed at each G94, also where that mode was set.
TEST(Verify, WantsTheFeedAgainBehindAFeedModeThatIsSaidOnceMore) {
  EXPECT_FALSE(verified(kProgram, replaced(kProgram, "X20 Y20\n", "G94\nX20 Y20\n")).proved());
  const std::string said = replaced(kProgram, "X20 Y20\n", "G94\nX20 Y20 F800\n");
  EXPECT_FALSE(verified(said, replaced(said, "X20 Y20 F800", "X20 Y20")).proved());
  EXPECT_TRUE(verified(said, replaced(said, "X20 Y20 F800", "X20 Y20 F800.0")).proved());
  const std::string nowhere = replaced(kProgram, "X20 Y20\n", "X20 Y20\nG94\nF800\nX20 Y20\n");
  EXPECT_TRUE(verified(nowhere, replaced(nowhere, "F800\nX20", "F800.0\nX20")).proved());
  EXPECT_FALSE(verified(nowhere, replaced(nowhere, "F800\nX20", "X20")).proved());
}

// A control that resets no planes at the end begins the next program with these.
TEST(Verify, SeesModesThatAreSetInTheBlockOfTheEnd) {
  const std::string program = "G21 G90 G17\nG0 X0 Y0 Z0\nG1 X60 F3000\nM30\n";
  for (const char* mode : {"G18", "G19", "G91", "G90.1"}) {
    const std::string other = replaced(program, "M30", std::string("M30 ") + mode);
    EXPECT_FALSE(verified(program, other).proved()) << mode;
    EXPECT_FALSE(verified(other, program).proved()) << mode;
    EXPECT_TRUE(verified(other, other).proved()) << mode;
  }
}

// LinuxCNC runs the two lines as one, straight to the corner on the other side.
TEST(Verify, DoesNotTakeALoneReturnForALineEnd) {
  const std::string apart = "G21 G90\nG0 X0 Y0 Z0\nG1 X60 F3000\nY60\nX0\nM2\n";
  EXPECT_TRUE(verified(apart, replaced(apart, "Y60\n", "Y60\r\r\n")).proved());
  EXPECT_FALSE(verified(apart, replaced(apart, "\nY60\n", "\rY60\r\r\n")).proved());
  EXPECT_FALSE(verified(replaced(apart, "\nY60\n", "\rY60\n"), apart).proved());
  const std::string same = replaced(apart, "\nY60\n", "\rY60\n");
  EXPECT_TRUE(verified(same, same).proved());
  // Where blocks are compared as texts, too.
  const std::string beside = "G21G90\nG0X0Y0Z0\nG41D1\nG1X60F3000\nY60\nX0\nM2\n";
  EXPECT_FALSE(verified(beside, replaced(beside, "\nY60\n", "\rY60\n")).proved());
  EXPECT_FALSE(verified(replaced(beside, "\nY60\n", "\rY60\n"), beside).proved());
}

// LinuxCNC does not run what stands behind a NUL, grbl does.
TEST(Verify, ComparesALineWithANulByItsBytes) {
  const std::string nul(1, '\0');
  const std::string plain = "G21 G90\nG0 X0 Y0 Z0\nG1 X60 F3000\nY60\nX0\nM2\n";
  const std::string in_front = replaced(plain, "Y60", nul + "Y60");
  const std::string behind = replaced(plain, "Y60", "Y60" + nul);
  for (const std::string& text : {in_front, behind}) {
    EXPECT_TRUE(verified(text, text).proved());
    EXPECT_FALSE(verified(plain, text).proved());
    EXPECT_FALSE(verified(text, plain).proved());
  }
  EXPECT_FALSE(verified(in_front, behind).proved());
}

TEST(Verify, SaysHowFarAProvedPathIs) {
  const Verification found = verified(kProgram, replaced(kProgram, "X30 Y0\n", "X30.006 Y0\n"));
  ASSERT_TRUE(found.proved());
  EXPECT_NEAR(found.deviation_mm, 0.006, 0.0003);
  EXPECT_TRUE(found.deviation_line == 11 || found.deviation_line == 12) << found.deviation_line;
  ASSERT_EQ(found.sections.size(), 1U);
  EXPECT_EQ(found.sections.front().old_first_block, 10U);  // line 11
  EXPECT_EQ(found.sections.front().old_last_block, 11U);
}

// A flat section, and one that climbs.
TEST(Verify, LooksASecondTimeAtFlatSectionsWhereThatIsAsked) {
  const auto program = [](const std::string& y, const std::string& z) {
    return "G21 G90 G17\nG0 X0 Y0 Z0\nG1 X5 Y" + y + " F100\nX10 Y0\nM8\nG1 X15 Y" + y + " Z" + z +
           "\nX20 Y0 Z2\nM30\n";
  };
  Promise promise(0.01);
  for (const bool twice : {false, true}) {
    promise.twice = twice;
    const Verification found =
        verify(ReadText(program("0", "1")).read(), ReadText(program("0.008", "1")).read(), promise);
    EXPECT_TRUE(found.proved());
    ASSERT_EQ(found.sections.size(), 2U);
    EXPECT_EQ(found.sections[0].in_region, twice);
    EXPECT_FALSE(found.sections[1].in_region);
  }
}

TEST(Verify, ListsNoStretchWhereNothingChanged) {
  const Verification found = verified(kProgram, kProgram);
  EXPECT_TRUE(found.proved());
  EXPECT_TRUE(found.sections.empty());
  EXPECT_EQ(found.deviation_mm, 0);
}

TEST(Verify, FindsEachBreachByItself) {
  std::string wrong = replaced(kProgram, "S12000", "S100");
  wrong = replaced(wrong, "X30 Y0\n", "X30.5 Y0\n");
  wrong = replaced(wrong, "M9\n", "");
  wrong = replaced(wrong, "X60 Y60\n", "X60 Y61\n");
  const Verification found = verified(kProgram, wrong);
  EXPECT_TRUE(has_violation(found, "event-changed"));
  EXPECT_TRUE(has_violation(found, "event-lost"));
  EXPECT_EQ(std::ranges::count(found.violations, std::string("distance"), &Violation::id), 2)
      << all_violations(found);
}

TEST(Verify, ComesToAnEndWhereProgramsHaveNothingInCommon) {
  std::string before = "G21 G90\nG0 X0 Y0 Z0\n";
  std::string after = before;
  for (int k = 0; k < 3000; ++k) {
    before += "M" + std::to_string(100 + k % 97) + "\n";
    after += "M" + std::to_string(300 + k % 89) + "\n";
  }
  EXPECT_FALSE(verified(before, after).proved());
  EXPECT_FALSE(verified(before, "").proved());
  EXPECT_FALSE(verified("", before).proved());
  EXPECT_TRUE(verified("", "").proved());
}

TEST(Verify, ThrowsWhenTheToleranceIsNoLength) {
  EXPECT_THROW(static_cast<void>(verdict(kProgram, kProgram, 0)), std::invalid_argument);
}

TEST(Verify, FindsAPathThatCrossesItselfWhereTheOldOneDoesNot) {
  // Out along Y0, round a loop, and back 0.015 mm beside it.
  const std::string before =
      "G21 G90 G17\nG0 X0 Y0\nG1 Z-1 F600\nX5\nX10\nX14 Y3\nX10 Y0.015\nX5\nX0\nG0 Z5\nM30\n";
  const std::string apart = replaced(before, "X5\nX10\n", "X5 Y-0.009\nX10 Y0\n");
  const std::string over = replaced(replaced(before, "X5\nX10\n", "X5 Y0.009\nX10 Y0\n"),
                                    "X5\nX0\n", "X5 Y0.006\nX0 Y0.015\n");
  EXPECT_TRUE(verified(before, apart).proved()) << all_violations(verified(before, apart));
  const Verification found = verified(before, over);
  ASSERT_EQ(found.violations.size(), 1u) << all_violations(found);
  EXPECT_EQ(found.violations[0].id, "crosses-itself");
  EXPECT_EQ(found.violations[0].kind, ViolationKind::kCrossing);
  EXPECT_EQ(found.violations[0].new_line, 4u);
  EXPECT_TRUE(verified(over, over).proved()) << "where it crossed before it may cross";
}

// --- any number of threads ------------------------------------------------------------------

// Many sections, each between two rapids.
std::string rows(double shift, int shifted_row) {
  std::string text = "G21 G90 G17\nM3 S1000\n";
  for (int row = 0; row < 30; ++row) {
    text += fmt::format("G0 Z5\nG0 X0 Y{}\nG1 Z-1 F500\n", row);
    for (int i = 1; i <= 20; ++i) {
      const double off = row == shifted_row && i == 10 ? shift : 0;
      text += fmt::format("X{:.3f} Y{:.4f}\n", 0.5 * i, row + 0.2 * std::sin(0.3 * i) + off);
    }
  }
  return text + "M30\n";
}

void expect_same(const Verification& a, const Verification& b) {
  EXPECT_EQ(a.proved(), b.proved());
  EXPECT_EQ(a.deviation_mm, b.deviation_mm);
  EXPECT_EQ(a.deviation_line, b.deviation_line);
  EXPECT_EQ(a.events_compared, b.events_compared);
  ASSERT_EQ(a.sections.size(), b.sections.size());
  for (std::size_t i = 0; i < a.sections.size(); ++i) {
    EXPECT_EQ(a.sections[i].old_first_block, b.sections[i].old_first_block);
    EXPECT_EQ(a.sections[i].comparison.bounds.at_most, b.sections[i].comparison.bounds.at_most);
  }
  ASSERT_EQ(a.violations.size(), b.violations.size());
  for (std::size_t i = 0; i < a.violations.size(); ++i) {
    EXPECT_EQ(a.violations[i].id, b.violations[i].id);
    EXPECT_EQ(a.violations[i].old_line, b.violations[i].old_line);
    EXPECT_EQ(a.violations[i].message, b.violations[i].message);
  }
}

TEST(ParallelVerification, GivesTheProofOfOneThread) {
  const ReadText before(rows(0, 0));
  const std::string lost_event = [] {
    std::string text = rows(0.004, 3);
    return text.replace(text.find("G0 X0 Y12\n"), 10, "G0 X0 Y12 M8\n");
  }();
  for (const std::string& text : {rows(0.004, 17), rows(0.02, 17), rows(0.02, 0), lost_event}) {
    const ReadText after(text);
    const ReadProgram old_program{&before.program, &before.meaning};
    const ReadProgram new_program{&after.program, &after.meaning};
    const Verification one = verify(old_program, new_program, 0.01);
    EXPECT_EQ(one.proved(), text == rows(0.004, 17));
    for (const int threads : {0, 1, 2, 3}) {
      SCOPED_TRACE(threads);
      expect_same(verify(old_program, new_program, 0.01, threads), one);
    }
  }
}

// --- numbers with and without a point, where nobody says for which control they are ----------

struct SpellingCase {
  const char* name;
  const char* before;
  const char* after;
  std::uint32_t line;  // of what is other; 0: nothing is
};

const SpellingCase kSpellings[] = {
    {"LostPoint", "G1 X10.\nX20.\n", "G1 X10.\nX20\n", 2},
    {"OnlyLength", "G1 X10. F100.\n", "G1 X10 F100.\n", 1},
    {"AnotherNumberWithoutPoint", "G1 X10.\nX20.\n", "G1 X10.\nX7\nX20.\n", 2},
    {"OneOfBothSpellings", "G1 X10.\nY10\n", "G1 X10\nY10\n", 1},
    {"CentreOfAnArc", "G2 X10. I5.\n", "G2 X10. I5\n", 1},
    {"AddedPoint", "G1 X10000\nX20000\n", "G1 X10000.\nX20000\n", 1},
    {"SameSpelling", "G1 X10.\nX20.\n", "G1 X10.\nX15.5\nX20.\n", 0},
    {"WholeNumbersWithoutPoint", "G1 X10 Y5.25\nX20\n", "G1 X10 Y5.25\nX7\n", 0},
    {"FixedDecimalsDropped", "G1 X10.000 Y5.250\n", "G1 X10 Y5.25\n", 0},
    {"CurveOfWholeNumbers", "G1 X10\nX20\n", "G1 X10.25\nX20\n", 0},
    {"Zero", "G1 X10. Y0.\n", "G1 X10. Y0\n", 0},
    {"Feed", "G1 X10. F100.\n", "G1 X10. F100\n", 1},
    {"FeedWithNewPoint", "G1 X10. F100\n", "G1 X10. F100.\n", 1},
    {"FeedsWithoutPoint", "G1 X10. F100\n", "G1 X10. F50\n", 0},
    {"FixedDecimalsOfFeed", "G1 X10. F100.00\n", "G1 X10. F100\n", 0},
    {"Count", "G1 X10.\nG81 X5. L3\n", "G1 X10.\nG81 X5. L3 P1\n", 0},
};

TEST(PointSpelling, IsOtherWhereSomeControlsReadAnotherLength) {
  for (const SpellingCase& test : kSpellings) {
    SCOPED_TRACE(test.name);
    const gcode::SourceText before("old.nc", test.before);
    const gcode::SourceText after("new.nc", test.after);
    const auto violation = other_point_spelling(before, after);
    ASSERT_EQ(violation.has_value(), test.line > 0) << (violation ? violation->message : "");
    if (!violation) continue;
    EXPECT_EQ(violation->id, "point-spelling");
    EXPECT_EQ(violation->new_line, test.line);
    EXPECT_NE(violation->message.find("--target"), std::string::npos);
  }
}

}  // namespace
}  // namespace batten::postproc
