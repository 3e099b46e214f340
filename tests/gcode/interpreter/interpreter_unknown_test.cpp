// What is forgotten: after a block that could have changed something, that something is
// unknown, until a word sets it again.
#include <gtest/gtest.h>

#include <string>

#include "gcode/state/reason.h"
#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

using tests::Interpreted;

constexpr const char* kStart =
    "G21 G90 G94 G17 G40 G49 G64 F100\nG54\nG0 X1 Y1 Z1\nG1 X2\n";  // 4 lines
constexpr const char* kAfter = "\nG1 X3\nY3\nZ3\nG1 X4 Y4 Z4\n";

struct UnknownPlaceCase {
  const char* block;
  bool x, y, z;  // known after it
};

const UnknownPlaceCase kPlaceAfterRows[] = {
    {"(text)", true, true, true},
    {"M3 S100", true, true, true},
    {"G4 P1", true, true, true},
    {"G4 X1", false, true, true},
    {"G4 X1.5", true, true, true},
    {"G4 P1. X1.5", false, true, true},
    {"G54", true, true, true},
    {"G55", false, false, false},
    {"G54.1 P3", false, false, false},
    {"G54 P3", false, false, false},
    {"G92 Y0", true, false, true},
    {"G92 Y0 G69", true, false, true},
    {"G92 E0", true, true, true},
    {"G92.1", false, false, false},
    {"G52 X1", false, false, false},
    {"G10 L2 P1 X0\nG1", false, false, false},
    {"G53 G1 Z0", true, true, false},
    {"G53", false, false, false},
    {"G53 G1 X1 Y1 Z1\nG0 X1 Y1 Z1", true, true, true},
    {"G53\nG0 X1 Y1 Z1\nG54", false, false, false},
    {"G52 X1\nG0 X1 Y1 Z1", true, true, true},
    {"G52 X1\nG0 X1 Y1 Z1\nG54", false, false, false},
    {"G11", true, true, true},
    {"G11 X1 Y1 P30", false, false, false},
    {"M3 $0 S100", true, true, true},
    {"M0 Change the tool", false, false, false},
    {"M94/1", false, false, false},
    {"G56 HA", false, false, false},
    {"G28 Z0", true, true, false},
    {"G28 W0", true, true, false},
    {"G28 A0", true, true, true},
    {"G30", false, false, false},
    {"G28.1", true, true, true},
    {"G28.1 X30", false, false, false},
    {"G30.1 G1 X10 Y10", false, false, false},
    {"G28.1 G2 I5", false, false, false},
    {"G43 H1", false, false, false},
    {"G43.1 X10 Z3", false, false, false},
    {"G49", false, false, false},
    {"H2", false, false, false},
    {"M6", false, false, false},
    {"T2", false, false, false},
    {"G1 X5 T2", false, false, false},
    {"G1 U5", false, true, true},
    {"G1 X#1 ", false, true, true},
    {"G1 X5 ,R1", false, false, false},
    {"#100=5", true, true, true},
    {"#<_depth>=5", true, true, true},
    {"#5221=5", false, false, false},
    {"##1=5", false, false, false},
    {"G41 D1\nG40", false, false, false},
    {"/G1 X9", false, true, true},
    {"/G1 X2", true, true, true},
    {"M150 P1", false, false, false},
    {"M100", false, false, false},
    {"G1 X5 M101", false, false, false},
    {"M12", true, true, true},
    // Assignments
    {"#52 21=5", false, false, false},
    {"N7 #5221=5", false, false, false},
    {"#100=1 #5221=5", false, false, false},
    {"IF[#1EQ1]THEN#100=5", true, true, true},
    {"IF[#1EQ1]THEN#5221=1.", false, false, false},
    {"N7 if [#1 eq 1] then # 5221 = 1.", false, false, false},
    {"IF[#1EQ1]THEN#[#2]=1.", false, false, false}};

// A call on Sinumerik, whose programs without marks are read like all others.
TEST(Interpret, KnowsNothingBehindAnLThatBelongsToNoWord) {
  const Interpreted it("G21 G90 G17\nG0 X1 Y1 Z1\nL54\nG1 X2 F9\n");
  EXPECT_EQ(it.line(3).barrier, reason::kNotUnderstood);
  EXPECT_FALSE(is_known(it.state_after_line(4)));
  const Interpreted repeated("G21 G90 G17\nG0 X1 Y1 Z1\nP5\nG1 X2 F9\n");
  EXPECT_TRUE(is_known(repeated.state_after_line(4)));
}

TEST(PlaceAfter, IsKnownOnTheseAxes) {
  for (const UnknownPlaceCase& test : kPlaceAfterRows) {
    SCOPED_TRACE(test.block);
    const Interpreted it(std::string(kStart) + test.block + kAfter);
    const std::size_t last = it.read.blocks.size();
    ASSERT_NE(it.motion_of_line(last - 3), nullptr);
    EXPECT_EQ(it.motion_of_line(last - 3)->start_known, test.x);
    EXPECT_EQ(it.motion_of_line(last - 2)->start_known, test.y);
    EXPECT_EQ(it.motion_of_line(last - 1)->start_known, test.z);
    EXPECT_TRUE(it.motion_of_line(last)->start_known);  // the words said all of it again
  }
}

TEST(Everything, IsUnknownAfterIt) {
  for (const char* block : {"M98 P1000", "M97 P10", "G1 X1 M98 P1", "M99", "G65 P9010", "o100 call",
                            "o1 if [#1 GT 2]", "WHILE [#1 LT 2] DO1", "O1234", "M30", "M72", "G777",
                            "CYCLE832(0.01)", "$RST=*", "G1 X", "/M98 P1",
                            // Words that exclude each other, and one that may do anything.
                            "G90 G91 G777", "G90 G91 M98 P1", "G90 G91 M30", "G68 G69 R10",
                            "G43.4 G49 H1", "G51 G50 X2", "G92 G10 X1", "G0 G1 G66 P1", "G66 P1 P2",
                            "G5 G1 P10000", "G90 G91 X#1", "G17 G18 G70 P1 Q2"}) {
    SCOPED_TRACE(block);
    const Interpreted it(std::string(kStart) + block + "\n");
    EXPECT_EQ(it.last_state(), unknown_modal_state());
  }
}

struct ExcludingRow {
  const char* block;
  void (*forget)(ModalState&);  // what the block can have changed
};

const ExcludingRow kExcludingRows[] = {
    {"G90 G91 X5", [](ModalState& s) { s.distance = DistanceMode::kUnknown; }},
    {"G17 G18", [](ModalState& s) { s.plane = Plane::kUnknown; }},
    {"G40 G41 D1", [](ModalState& s) { s.cutter_compensation = TriState::kUnknown; }},
    {"G61 G64", [](ModalState& s) { s.path = PathMode::kUnknown; }},
    {"G93 G94",
     [](ModalState& s) {
       s.feed_mode = FeedMode::kUnknown;
       s.feed.reset();
     }},
    {"G20 G21 F500",
     [](ModalState& s) {
       s.units = Units::kUnknown;
       s.feed.reset();
     }},
    {"G0 G1 X5", [](ModalState& s) { s.motion = MotionMode::kUnknown; }},
    {"G81 G0 X5 Z-1 R1", [](ModalState& s) { s.motion = MotionMode::kUnknown; }},
    {"X1 X2", [](ModalState&) {}},
    {"G1 X1 Y1 X2", [](ModalState&) {}},
    {"F500 F600", [](ModalState& s) { s.feed.reset(); }},
    {"M3 M5", [](ModalState&) {}},
    // What one word would set, though the fault lies with others.
    {"X1 X2 G91", [](ModalState& s) { s.distance = DistanceMode::kUnknown; }},
    {"X1 X2 G20",
     [](ModalState& s) {
       s.units = Units::kUnknown;
       s.feed.reset();
     }},
};

TEST(Modes, AreUnknownAfterWordsThatExcludeEachOtherAsFarAsAnyOfThemSetsThem) {
  for (const ExcludingRow& row : kExcludingRows) {
    SCOPED_TRACE(row.block);
    const Interpreted it("G21 G90 G17 G94 G40 G64\nG0 X0 Y0 Z0\nG1 F500\n" +
                         std::string(row.block) + "\nG1 X9 Y9 Z9\n");
    ModalState expected = it.state_after_line(3);
    row.forget(expected);
    EXPECT_EQ(it.state_after_line(4), expected);
    ASSERT_TRUE(expected.distance == DistanceMode::kUnknown || it.motion_of_line(5) != nullptr);
    if (expected.distance == DistanceMode::kUnknown) continue;
    EXPECT_FALSE(it.motion_of_line(5)->start_known);  // refused, or moved
  }
}

TEST(Modes, AreKnownAgainOnceSaidAgain) {
  const Interpreted it(
      "G21 G90 G17 G94 G40 G64\nG0 X0 Y0 Z0\nG1 F500\nG90 G91 X1\nG90\n"
      "G1 X1 Y1 Z1\nX2\n");
  EXPECT_TRUE(is_known(it.last_state()));
  EXPECT_TRUE(it.motion_of_line(7)->start_known);
}

// --- calls that keep modes ---------------------------------------------------------------------

TEST(KeptModes, AreKnownBehindACall) {
  for (const char* block : {"M98 P1000", "M97 P10", "M198 P1", "G1 X1 M98 P1", "G65 P9010 A1.",
                            "o100 call", "N5 o<do_if_sub> call [1] [#2]", "o#1 call"}) {
    SCOPED_TRACE(block);
    const Interpreted it(std::string(kStart) + block + "\nX5 Y5 Z5\nG1 X5 Y5 Z5\nX6\n",
                         ReadOptions{.calls_keep_modes = true});
    ModalState expected = it.state_after_line(4);
    expected.motion = MotionMode::kUnknown;
    expected.feed.reset();
    EXPECT_EQ(it.state_after_line(5), expected);
    EXPECT_EQ(it.motion_of_line(6),
              nullptr);  // which kind of motion, only the program called knows
    EXPECT_FALSE(it.motion_of_line(7)->start_known);
    EXPECT_TRUE(it.motion_of_line(8)->start_known);
  }
}

TEST(NotKeptModes, AreUnknownAllTheSame) {
  for (const char* block :
       {"M99", "G66 P9010", "o1 if [#1 GT 2]", "o<call> sub", "WHILE [#1 LT 2] DO1", "O1234", "M30",
        "M72", "M98 P5 M30", "G777", "G1 X"}) {
    SCOPED_TRACE(block);
    const Interpreted it(std::string(kStart) + block + "\n", ReadOptions{.calls_keep_modes = true});
    ModalState state = it.last_state();
    state.modal_macro = TriState::kUnknown;
    EXPECT_EQ(state, unknown_modal_state());
  }
}

// Where LinuxCNC 2.9 is behind a block of two kinds of codes that began at X5 Y6 Z3 under G1: what
// its rs274 said.
struct LinuxCncPlace {
  const char* block;
  double x, y, z;
  const char* motion = "G1";  // the mode that the next block moves in
};
constexpr LinuxCncPlace kLinuxCncPlaces[] = {
    {"G4 P0.1 X10 Y10", 10, 10, 3},
    {"G4 P0.1 G0 X10 Y10", 10, 10, 3, "G0"},
    {"G4 P0.1 G81 X1 Y1 Z-1 R2", 1, 1, 2, "G81"},
    {"G10 L2 P1 X10 Y10", -5, -4, 3},
    {"G10 L2 P1 Z3", 5, 6, 0},
    {"G10 L20 P1 X10 Y10", 10, 10, 3},
    {"G28", 0, 0, 0},
    {"G28 X10 Y10", 0, 0, 3},
    {"G28 Z3", 5, 6, 0},
    {"G28.1", 5, 6, 3},
    {"G28.1 X10 Y10", 10, 10, 3},
    {"G28.1 G1 X10 Y10", 10, 10, 3},
    {"G28.1 G0 X10 Y10", 10, 10, 3, "G0"},
    {"G28.1 G81 X1 Y1 Z-1 R2", 1, 1, 2, "G81"},
    {"G30 X10 Y10", 0, 0, 3},
    {"G30.1", 5, 6, 3},
    {"G30.1 X10 Y10", 10, 10, 3},
    {"G30.1 G1 X10 Y10", 10, 10, 3},
    {"G30.1 G0 X10 Y10", 10, 10, 3, "G0"},
    {"G43.1 X10 Y10", -5, -4, 3},
    {"G43.1 G1 X10 Y10", 10, 10, 3},
    {"G43.1 G0 X10 Y10", 10, 10, 3, "G0"},
    {"G43.1 Z3", 5, 6, 0},
    {"G52 X10 Y10", -5, -4, 3},
    {"G52 Z3", 5, 6, 0},
    {"G53 X10 Y10", 10, 10, 3},
    {"G53 G0 X10 Y10", 10, 10, 3, "G0"},
    {"G92 X10 Y10", 10, 10, 3},
    {"G92.1 X10 Y10", 10, 10, 3},
    {"G92.1 G0 X10 Y10", 10, 10, 3, "G0"},
    {"G92.2 G1 X10 Y10", 10, 10, 3},
    {"G92.3 Z3", 5, 6, 3},
    {"G92.3 G81 X1 Y1 Z-1 R2", 1, 1, 2, "G81"},
    {"G40 G0 X10 Y10", 10, 10, 3, "G0"},
    {"G49 G1 X10 Y10", 10, 10, 3},
    {"G64 P0.1 X10 Y10", 10, 10, 3},
    {"M6 X10 Y10", 10, 10, 3},
};

// One axis in the next block shows where that began.
TEST(InterpreterUnknown, ThePlaceBesideOtherCodesIsLinuxCncsOrUnknown) {
  for (const LinuxCncPlace& row : kLinuxCncPlaces) {
    SCOPED_TRACE(row.block);
    const double places[] = {row.x, row.y, row.z};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Interpreted it(
          std::string("G21 G90 G94 G17 G40 G49 G54 F3000\nG0 X1 Y2 Z3\nG1 X5 Y6\n") + row.block +
          "\n" + "XYZ"[axis] + "50\n");
      const Motion* next = it.motion_of_line(5);
      if (next == nullptr) continue;  // kept as it is
      EXPECT_EQ(next->kind == MotionKind::kRapid, std::string_view(row.motion) == "G0");
      if (!next->start_known) continue;
      EXPECT_EQ(next->piece.start()[static_cast<Eigen::Index>(axis)], places[axis]) << axis;
    }
  }
}

TEST(InterpreterUnknown, AJumpThatIsNotTakenChangesNothing) {
  const Interpreted it(std::string(kStart) + "IF [#1 GT 2] GOTO 900\nG1 X5\n");
  EXPECT_TRUE(it.motion_of_line(6)->start_known);
  EXPECT_EQ(it.last_state(), it.state_after_line(4));
}

TEST(InterpreterUnknown, ADeletableBlockMakesUnknownWhatItChanges) {
  const Interpreted it(std::string(kStart) + "/G91 F200\n");
  EXPECT_EQ(it.last_state().distance, DistanceMode::kUnknown);
  EXPECT_EQ(it.last_state().feed, std::nullopt);
  EXPECT_EQ(it.last_state().units, Units::kMillimetre);
  EXPECT_EQ(it.last_state().plane, Plane::kXY);
  const Interpreted units(std::string(kStart) + "/G20\nG1 X2 Y2 Z2\nX3\n");
  EXPECT_EQ(units.last_state().units, Units::kUnknown);
  EXPECT_FALSE(units.motion_of_line(6)->start_known) << "units take the position along";
}

TEST(InterpreterUnknown, ModesThatAreSetAgainAreKnownAgain) {
  const Interpreted it(std::string(kStart) + "M98 P1\nG21 G90 G18 G94 G61 G40\nG1 X1 F50\n");
  const ModalState& now = it.last_state();
  EXPECT_EQ(now.units, Units::kMillimetre);
  EXPECT_EQ(now.distance, DistanceMode::kAbsolute);
  EXPECT_EQ(now.plane, Plane::kZX);
  EXPECT_EQ(now.path, PathMode::kExactPath);
  EXPECT_EQ(now.cutter_compensation, TriState::kOff);
  EXPECT_EQ(now.feed, 50.0);
  EXPECT_EQ(now.scaling, TriState::kUnknown);  // nobody said G50
  EXPECT_FALSE(is_known(now));
}

TEST(InterpreterUnknown, AxisWordsInACycleAreNoLines) {
  const Interpreted it(std::string(kStart) + "G81 X5 Y5 Z-3 R1\nX6\nG80\nX7\nG0 X8\n");
  EXPECT_EQ(it.line(6).barrier, reason::kCannedCycle);
  EXPECT_EQ(it.motion_of_line(6), nullptr);
  EXPECT_EQ(it.motion_of_line(8), nullptr);  // a line on FANUC, an error on LinuxCNC
  ASSERT_NE(it.motion_of_line(9), nullptr);
  EXPECT_FALSE(it.motion_of_line(9)->start_known);
}

TEST(InterpreterUnknown, RepeatedModesCountOnlyAfterTheyWereSaid) {
  const Interpreted it(std::string(kStart) + "M98 P1\nG90\nG90\n");
  EXPECT_EQ(it.line(6).kind, BlockKind::kSettings);
  EXPECT_EQ(it.line(7).kind, BlockKind::kEmpty);
}

TEST(InterpreterUnknown, TextAfterTheLastMarkIsInert) {
  const Interpreted it("%\nG21 G0 X1\n%\nG20 more\n");
  EXPECT_EQ(it.line(4).barrier, reason::kProgramMark);
  EXPECT_EQ(it.last_state().units, Units::kMillimetre);
}

// Klipper knows no command X4 and none F777: it leaves them out, other builds may not.
TEST(BlocksWithoutACommand, MayBeLeftOutWhereEachBlockIsACommand) {
  const std::string text = "G21\nG90\nG1 X1 Y1 Z0 F100\nX2\nG1 X3 Y3\nF777\nG1 X4 Y4\nG1 X5 F200\n";
  ReadOptions options;
  options.needs_commands = true;
  const Interpreted commands(text, options);
  EXPECT_EQ(commands.motion_of_line(4), nullptr);
  EXPECT_EQ(commands.line(4).barrier, reason::kNoCommand);
  ASSERT_NE(commands.motion_of_line(5), nullptr);
  EXPECT_FALSE(commands.motion_of_line(5)->start_known);
  EXPECT_EQ(commands.state_after_line(5).feed, 100.0);
  EXPECT_FALSE(commands.state_after_line(7).feed);
  EXPECT_EQ(commands.state_after_line(8).feed, 200.0);
  const Interpreted words(text);
  ASSERT_NE(words.motion_of_line(5), nullptr);
  EXPECT_TRUE(words.motion_of_line(5)->start_known);
  EXPECT_EQ(words.state_after_line(7).feed, 777.0);
}

}  // namespace
}  // namespace batten::gcode
