// Words to motions in absolute millimetres, and what a block is. Expected places are computed
// by hand from the words.
#include "gcode/interpreter/interpreter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "gcode/state/reason.h"
#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

using geometry::Point3;
using tests::Interpreted;

// --- places -------------------------------------------------------------------------------------

struct PlaceCase {
  const char* text;  // the last motion ends at `end`
  Point3 end;
};

const PlaceCase kEndOfLastMotionRows[] = {{"G21\nG1 X1 Y2 Z3 F9\n", {1, 2, 3}},
                                          {"G20\nG1 X1 Y-.5 Z3 F9\n", {25.4, -12.7, 76.2}},
                                          {"G20 G0 X1 Y0 Z0\n", {25.4, 0, 0}},
                                          {"G20\nG0 X1 Y1 Z1\nG21 X5\n", {5, 25.4, 25.4}},
                                          {"G70\nG0 X1 Y0 Z0\n", {25.4, 0, 0}},
                                          {"G21\nG1 X1 Y1 Z1 F9\nX2\nY5\n", {2, 5, 1}},
                                          {"G21\nG0 X1 Y2 Z3\nG91\nG1 X1 Z-1 F9\nX1\n", {3, 2, 2}},
                                          {"G21\nG0 X1 Y2 Z3\nG91 X9\nG90 X4\n", {4, 2, 3}},
                                          {"g21\ng1x1y2z3f9\n", {1, 2, 3}},
                                          {"G21\nG80 G0 X1 Y2 Z3\n", {1, 2, 3}},
                                          {"G21 G54\nG0 X1 Y2 Z3\nG54\nX7\n", {7, 2, 3}},
                                          {"G21\nG0 X1 Y2 Z3\nG28.1\nX7\n", {7, 2, 3}},
                                          {"G21\nG0 X1 Y2 Z3\n#5=7\nX7\n", {7, 2, 3}},
                                          {"G21\nG0 X1 Y2 Z3\nM101 P3\nX7\n", {7, 0, 0}}};

TEST(EndOfLastMotion, IsAbsoluteInMillimetres) {
  for (const PlaceCase& test : kEndOfLastMotionRows) {
    SCOPED_TRACE(test.text);
    const Interpreted it(test.text);
    ASSERT_FALSE(it.read.motions.empty());
    const Motion& motion = it.read.motions.back();
    EXPECT_TRUE(motion.end_known);
    EXPECT_LT((motion.piece.end() - test.end).norm(), 1e-12);
  }
}

TEST(Interpreter, KnowsAnAxisFromItsFirstWordOn) {
  const Interpreted it("G21\nG0 X1 Y1\nG1 X2 F9\nG1 Z1\nG1 Z2\n");
  EXPECT_FALSE(it.motion_of_line(2)->start_known);  // X and Y come from somewhere
  EXPECT_TRUE(it.motion_of_line(3)->start_known);   // Z may be anywhere, but stays there
  EXPECT_FALSE(it.motion_of_line(4)->start_known);
  EXPECT_TRUE(it.motion_of_line(5)->start_known);
}

TEST(Interpreter, DoesNotKnowThePlaceAfterAnIncrementFromAnUnknownPlace) {
  const Interpreted it("G21 G91\nG1 X1 Y1 F9\nG90\nG1 X5\n");
  EXPECT_FALSE(it.motion_of_line(2)->end_known);
  EXPECT_FALSE(it.motion_of_line(4)->start_known);
  EXPECT_TRUE(it.motion_of_line(4)->end_known);
}

TEST(Interpreter, ChainsMotionsWithoutGaps) {
  constexpr int kPrograms = 100;
  int compared = 0;
  for (int seed = 0; seed < kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(static_cast<unsigned>(seed));
    std::uniform_int_distribution<int> pick(0, 9);
    std::string text = "G21 G90 G94 F100\nG0 X0 Y0 Z0\n";
    for (int i = 0; i < 60; ++i) {
      static constexpr const char* kBlocks[] = {
          "G1 X1.5", "Y-2 Z3",        "G0 Z5",          "G91",          "G90", "G20",
          "G21",     "G2 X3 Y3 R500", "G18 G3 X1 R-99", "G1 X-2 Y.5 Z1"};
      text += kBlocks[pick(random)];
      text += '\n';
    }
    const Interpreted it(text);
    for (std::size_t i = 1; i < it.read.motions.size(); ++i) {
      const auto opaque = [](const BlockMeaning& block) {
        return block.kind == BlockKind::kOpaque;
      };
      const auto first = it.read.blocks.begin() + it.read.motions[i - 1].block;
      const auto last = it.read.blocks.begin() + it.read.motions[i].block;
      if (!it.read.motions[i].start_known || std::any_of(first, last, opaque)) {
        continue;  // an arc that could not be followed stands between them
      }
      ++compared;
      const Point3 from = it.read.motions[i - 1].piece.end();
      const Point3 to = it.read.motions[i].piece.start();
      for (int axis = 0; axis < 3; ++axis) {
        if (it.read.motions[i].axes_named[static_cast<std::size_t>(axis)]) {
          ASSERT_NEAR(from[axis], to[axis], 1e-12) << "motion " << i;
        }
      }
    }
  }
  EXPECT_GT(compared, 20 * kPrograms);
}

// --- feed ---------------------------------------------------------------------------------------

TEST(Interpreter, ReadsFeedsInMillimetresPerMinute) {
  const Interpreted it("G20\nG94 F10\nG1 X1\nF20\nG93\nG1 X2 F3\n");
  EXPECT_EQ(it.state_after_line(2).feed, 254.0);
  EXPECT_EQ(it.state_after_line(4).feed, 508.0);
  EXPECT_EQ(it.state_after_line(5).feed, std::nullopt);  // 508 is not 508 per minute
  EXPECT_EQ(it.state_after_line(6).feed, 3.0);           // 1/min has no inch in it
}

// LinuxCNC reads such an F in the units before the block, grbl in those after it.
TEST(Interpreter, TakesNoFeedFromABlockThatChangesTheUnits) {
  EXPECT_EQ(Interpreted("G20 F6\n").last_state().feed, std::nullopt);
  EXPECT_EQ(Interpreted("G20\nF6\nF6 G21\n").last_state().feed, std::nullopt);
  EXPECT_EQ(Interpreted("G21\nG20 F6\nG1 X1\nF7\n").last_state().feed, 7 * 25.4);
  EXPECT_EQ(Interpreted("G20\nG20 F10\n").last_state().feed, 254.0);
}

TEST(Interpreter, TakesNoFeedFromADwellOrAZero) {
  EXPECT_EQ(Interpreted("G21\nG4 F5\n").last_state().feed, std::nullopt);
  EXPECT_EQ(Interpreted("G21\nG1 X1 F0\n").last_state().feed, std::nullopt);
}

// --- what a block is ----------------------------------------------------------------------------

constexpr const char* kPreamble = "G21 G90 G94 G17 G40 F100 S500\nG0 X0 Y0 Z0\nG1 X1\n";

struct BlockCase {
  const char* block;  // after kPreamble
  BlockKind kind;
  std::string_view barrier;
};

const BlockCase kBlockInAProgramRows[] = {
    {"G1 X2", BlockKind::kMotion, {}},
    {"N40 X2 Y3", BlockKind::kMotion, {}},
    {"G1 X2 F100.000", BlockKind::kMotion, {}},
    {"G1 X2 F200", BlockKind::kMotion, {}},
    {"G1 X2 S500", BlockKind::kMotion, {}},
    {"G90 G21 G17 G40 G1 X2", BlockKind::kMotion, {}},
    {"G1 X2 (text) ; more", BlockKind::kMotion, {}},
    {"F200", BlockKind::kSettings, {}},
    {"N40", BlockKind::kEmpty, {}},
    {"(text)", BlockKind::kEmpty, {}},
    {"G90", BlockKind::kEmpty, {}},
    {"G1", BlockKind::kEmpty, {}},
    // Nothing in the program said so before: the control may have started otherwise.
    {"G64 G1 X2", BlockKind::kMotionAndMore, reason::kStateChange},
    {"G91.1", BlockKind::kSettings, reason::kStateChange},
    {"G1 X2 S600", BlockKind::kMotionAndMore, reason::kSpindle},
    {"M3", BlockKind::kSettings, reason::kSpindle},
    {"G1 X2 M8", BlockKind::kMotionAndMore, reason::kCoolant},
    {"M62 P1", BlockKind::kSettings, reason::kMiscFunction},
    {"M110", BlockKind::kSettings, reason::kMiscFunction},
    {"G0 X2", BlockKind::kMotion, reason::kRapid},
    {"G0", BlockKind::kSettings, reason::kStateChange},
    {"G2 X2 I.5", BlockKind::kMotion, reason::kArc},
    {"G20 G1 X2", BlockKind::kMotionAndMore, reason::kStateChange},
    {"G18", BlockKind::kSettings, reason::kStateChange},
    {"G4 P1", BlockKind::kSettings, reason::kDwell},
    {"G1 X2 A30", BlockKind::kMotionAndMore, reason::kOtherAxis},
    {"G1 A30", BlockKind::kSettings, reason::kOtherAxis},
    {"G1 X2 E.1", BlockKind::kMotionAndMore, reason::kExtruder},
    {"T2", BlockKind::kSettings, reason::kToolChange},
    {"T2 M6", BlockKind::kSettings, reason::kToolChange},
    {"G43 H1 Z5", BlockKind::kMotionAndMore, reason::kToolChange},
    {"G55", BlockKind::kSettings, reason::kCoordinateChange},
    {"G53 G0 Z0", BlockKind::kSettings, reason::kCoordinateChange},
    {"G28 Z0", BlockKind::kSettings, reason::kCoordinateChange},
    {"G92 X0", BlockKind::kSettings, reason::kCoordinateChange},
    {"G10 L2 P1 X0", BlockKind::kSettings, reason::kCoordinateChange},
    {"G81 X5 Z-3 R1", BlockKind::kSettings, reason::kCannedCycle},
    {"G33 Z-5 K1", BlockKind::kSettings, reason::kThreading},
    {"G38.2 Z-5", BlockKind::kSettings, reason::kProbe},
    {"G5 X5 I1 J1 P-1 Q-1", BlockKind::kSettings, reason::kSpline},
    {"G6.2 P4 K0 X1 R1", BlockKind::kSettings, reason::kSpline},
    {"G1 X2 R1", BlockKind::kOpaque, reason::kCornerWord},
    {"G1 X2 ,C1", BlockKind::kOpaque, reason::kCornerWord},
    {"G1 X2 I1", BlockKind::kOpaque, reason::kNotUnderstood},
    {"P3", BlockKind::kOpaque, reason::kNotUnderstood},
    {"G1 X[1+2]", BlockKind::kOpaque, reason::kExpression},
    {"G1 X#5", BlockKind::kOpaque, reason::kExpression},
    {"#5=3", BlockKind::kOpaque, reason::kAssignment},
    {"/G1 X2", BlockKind::kOpaque, reason::kBlockDelete},
    {"(MSG, hello)", BlockKind::kSettings, reason::kActiveComment},
    {"(a (b)", BlockKind::kSettings, reason::kActiveComment},
    {"(a", BlockKind::kSettings, reason::kActiveComment},
    {"; (a", BlockKind::kEmpty, {}},
    {"G1 X2 (DEBUG, x)", BlockKind::kMotionAndMore, reason::kActiveComment},
    {"M0", BlockKind::kSettings, reason::kProgramEnd},
    {"M30", BlockKind::kSettings, reason::kProgramEnd},
    {"M98 P100", BlockKind::kSettings, reason::kSubprogram},
    {"G65 P9000 X1", BlockKind::kSettings, reason::kSubprogram},
    {"IF [#1 GT 2] GOTO 90", BlockKind::kOpaque, reason::kProgramFlow},
    {"$H", BlockKind::kOpaque, reason::kForeignWords},
    {"G777", BlockKind::kOpaque, reason::kNotUnderstood},
    {"G0 G1 X2", BlockKind::kOpaque, reason::kNotUnderstood},
    {"G1 X2 X3", BlockKind::kOpaque, reason::kNotUnderstood}};

TEST(BlockInAProgram, HasThisMeaning) {
  for (const BlockCase& test : kBlockInAProgramRows) {
    SCOPED_TRACE(test.block);
    const Interpreted it(std::string(kPreamble) + test.block);
    ASSERT_EQ(it.read.blocks.size(), 4U);
    EXPECT_EQ(it.line(4).kind, test.kind);
    EXPECT_EQ(it.line(4).barrier, test.barrier);
  }
}

// --- diagnostics --------------------------------------------------------------------------------

TEST(Interpreter, AsksForUnitsWhereAProgramNamesNone) {
  const Interpreted none("(part)\nG0 X1\nG1 X2 F9\n");
  EXPECT_FALSE(none.read.unit_word_seen);
  ASSERT_TRUE(none.has_diagnostic("units-missing"));
  EXPECT_EQ(none.found.back().severity, Severity::kError);
  EXPECT_EQ(none.program.source.place_of(none.found.back().where.begin).line, 2U);

  EXPECT_FALSE(Interpreted("G0 X1\n", Units::kInch).has_diagnostic("units-missing"));
  EXPECT_FALSE(Interpreted("G0 X1\nG21\n").has_diagnostic("units-missing"));
  EXPECT_FALSE(Interpreted("M3\n").has_diagnostic("units-missing"));  // nothing moves
}

TEST(Interpreter, FollowsMotionsBeforeTheFirstUnitWordInUnknownUnits) {
  const Interpreted it("G0 X1 Y1 Z1\nX2\nG20\nG1 X3 F9\n");
  EXPECT_EQ(it.state_after_line(2).units, Units::kUnknown);
  EXPECT_TRUE(it.motion_of_line(2)->start_known);
  EXPECT_FALSE(it.motion_of_line(4)->start_known);  // 2 of what?
}

struct TroubleCase {
  const char* block;
  const char* id;
};

const TroubleCase kTroubleRows[] = {{"G17 G18 X1", "two-words-of-one-group"},
                                    {"M0 M1", "two-words-of-one-group"},
                                    {"G1 G1 X2", "two-words-of-one-group"},
                                    {"X1 Y2 X3", "word-repeated"},
                                    {"G1.25 X1", "bad-code"},
                                    {"M-3", "bad-code"},
                                    {"G777 X2", "unknown-g-code"},
                                    {"G2 X5", "arc-centre-missing"},
                                    {"G2 X5 Y5 I1 J0", "arc-radius-mismatch"},
                                    {"G2 X5 R1", "arc-radius-too-small"},
                                    {"G2 X5 I2 R2", "arc-words-conflict"}};

TEST(Trouble, IsToldOnceAndLeavesTheBlockAlone) {
  for (const TroubleCase& test : kTroubleRows) {
    SCOPED_TRACE(test.block);
    const Interpreted it(std::string(kPreamble) + test.block);
    ASSERT_EQ(it.found.size(), 1U);
    EXPECT_EQ(it.found.front().id, test.id);
    EXPECT_EQ(it.found.front().severity, Severity::kWarning);
    EXPECT_EQ(it.program.source.place_of(it.found.front().where.begin).line, 4U);
    EXPECT_EQ(it.line(4).kind, BlockKind::kOpaque);
    EXPECT_EQ(it.motion_of_line(4), nullptr);
  }
}

TEST(Interpreter, ReportsAnUnknownCodeOnceAndCountsWhatIsTooMuch) {
  EXPECT_EQ(Interpreted("G21\nG777\nG777\nG778\n").found.size(), 2U);
  std::string text = "G21 G0 X0 Y0 Z0\n";
  for (int i = 0; i < 60; ++i) text += "G2 X1 Y1 F9\nG0 X0 Y0\n";
  const Interpreted it(text);
  EXPECT_EQ(it.found.size(), 51U);
  EXPECT_EQ(it.found.back().message, "this and 9 more blocks after it have the same trouble");
}

// What P and Q say holds until the next of these words.
TEST(Interpreter, KnowsHowFarABlendMayLeaveTheJoints) {
  const auto after = [](const std::string& words) {
    return Interpreted("G21 G90 G17\n" + words + "\n").last_state().path;
  };
  EXPECT_EQ(after("G1 X1 F100").blend_tolerance, std::nullopt);
  EXPECT_EQ(after("G64").blend_tolerance, 0);
  EXPECT_EQ(after("G64").naive_cam_tolerance, 0);
  EXPECT_EQ(after("G64 P0.05").blend_tolerance, 0.05);
  EXPECT_EQ(after("G64 P0.05").naive_cam_tolerance, 0.05);
  EXPECT_EQ(after("G64 P0.05 Q0.01").naive_cam_tolerance, 0.01);
  EXPECT_EQ(after("G20 G64 P0.01").blend_tolerance, 0.254);
  EXPECT_EQ(after("G64 P0.05\nG64").blend_tolerance, 0);
  EXPECT_EQ(after("G64 P0.05\nG61").blend_tolerance, std::nullopt);
  EXPECT_EQ(after("G64 P0.05\nM98 P1").blend_tolerance, std::nullopt);
  EXPECT_EQ(after("G64 P0.05\n/G64 P0.1"), PathControl(PathMode::kBlending));
}

}  // namespace
}  // namespace batten::gcode
