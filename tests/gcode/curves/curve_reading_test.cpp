// Curves in the midst of a program: those that the control is known to read are motions.
#include <gtest/gtest.h>

#include <string>

#include "gcode/curves/g5_curve.h"
#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

using geometry::Point3;

struct CurveProgram {
  explicit CurveProgram(const std::string& text, const CurveFormat* curves = &linuxcnc_g5())
      : program(parse(SourceText("test.nc", text), found)),
        read(interpret(program, {.curves = curves}, found)) {}

  [[nodiscard]] const BlockMeaning& line(std::size_t number) const {
    return read.blocks.at(number - 1);
  }
  [[nodiscard]] const ModalState& state_after(std::size_t number) const {
    return read.states.at(line(number).state_after);
  }

  Diagnostics found;
  Program program;
  Interpretation read;
};

const std::string kHead = "G21 G90 G17\nG0 X0 Y0 Z0\nG1 Z-1 F500\n";
const std::string kG5 = "G5 X18 Y6.4 I10 J0 P-4 Q-2.4 F800\n";

TEST(Curves, AreMotionsThatAreCopied) {
  const CurveProgram p(kHead + kG5 + "G1 X50\n");
  const BlockMeaning& curve = p.line(4);
  EXPECT_TRUE(curve.of_curve);
  EXPECT_EQ(curve.barrier, reason::kSpline);
  ASSERT_GE(curve.motion, 0);
  const Motion& motion = p.read.motions.at(static_cast<std::size_t>(curve.motion));
  EXPECT_EQ(motion.kind, MotionKind::kCurve);
  EXPECT_EQ(motion.block, 3U);
  EXPECT_EQ(geometry::point_at(motion.piece, 1), Point3(18, 6.4, -1));
  EXPECT_EQ(p.state_after(4).motion, MotionMode::kOther);
  EXPECT_EQ(p.state_after(4).feed, 800);
}

TEST(Curves, LeaveTheToolWhereTheyEnd) {
  const CurveProgram p(kHead + kG5 + "G1 X50\n");
  const Motion& after = p.read.motions.back();
  EXPECT_TRUE(after.start_known);
  EXPECT_EQ(geometry::start_point(after.piece), Point3(18, 6.4, -1));
  EXPECT_EQ(geometry::end_point(after.piece), Point3(50, 6.4, -1));
}

// As before there were any: nothing is known behind them.
TEST(Curves, OfAnotherControlAreNotFollowed) {
  const CurveProgram p(kHead + kG5 + "G1 X50\n", nullptr);
  EXPECT_FALSE(p.line(4).of_curve);
  EXPECT_EQ(p.line(4).motion, -1);
  EXPECT_EQ(p.line(4).barrier, reason::kSpline);
  EXPECT_FALSE(p.read.motions.back().start_known);
}

// LinuxCNC: "Bad character 'n' used".
TEST(Curves, AreNotReadWithANumberBehindTheirFirstWord) {
  EXPECT_TRUE(CurveProgram(kHead + "N40 " + kG5).line(4).of_curve);
  EXPECT_FALSE(CurveProgram(kHead + "G5 X18 Y6.4 N5 I10 J0 P-4 Q-2.4 F800\n").line(4).of_curve);
  EXPECT_FALSE(CurveProgram(kHead + "(a) N40 " + kG5).line(4).of_curve);
}

TEST(Curves, AreNotFollowedInAnUnsafeState) {
  const std::string bare = "G5 X18 Y6.4 I10 J0 P-4 Q-2.4";
  for (const std::string& text :
       {kHead + "G41 D1\nG1 X1 Y1\n" + bare, kHead + "G93\nG1 X1 Y1 F2\n" + bare,
        kHead + "G95\nG1 X1 Y1 F2\n" + bare, kHead + "G91\n" + bare, kHead + "G18\n" + bare,
        kHead + "G12.1\nG1 X1 Y1\n" + bare, "G90\nG1 X0 Y0 F500\n" + bare,
        "G21 G90 G17 F500\n" + bare, kHead + "/" + bare, kHead + "WHILE [#1 LT 5] DO1\n" + bare}) {
    const CurveProgram p(text);
    const BlockMeaning& last = p.read.blocks.back();
    EXPECT_FALSE(last.of_curve) << text;
    EXPECT_EQ(last.motion, -1) << text;
  }
}

}  // namespace
}  // namespace batten::gcode
