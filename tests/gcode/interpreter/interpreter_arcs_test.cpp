// G2 and G3: centres, sweeps and planes. The expected numbers are worked out by hand; the sense
// of rotation in each plane is that of RS-274: clockwise seen from the positive end of the axis
// that is normal to the plane.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "gcode/interpreter/motion_words.h"
#include "gcode/state/reason.h"
#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

using geometry::Point3;
using geometry::Vector3;
using tests::Interpreted;

constexpr double kPi = std::numbers::pi;

struct ArcCase {
  const char* text;  // the last block is the arc
  Point3 end;
  Point3 center;  // its place along the axis does not count
  Vector3 axis;
  double sweep;
};

const Vector3 kX = Vector3::UnitX();
const Vector3 kY = Vector3::UnitY();
const Vector3 kZ = Vector3::UnitZ();

// R10 over a chord of 10: half the chord is 5, so the angle is 2 asin(1/2) = 60 degrees and the
// centre is 10 cos(30) off the chord.
const double kOff = 10 * std::cos(kPi / 6);

const ArcCase kLastArcRows[] = {
    {"G21 G0 X0 Y0 Z0\nG3 X10 Y10 I0 J10 F9", {10, 10, 0}, {0, 10, 0}, kZ, kPi / 2},
    {"G21 G0 X0 Y0 Z0\nG2 X10 Y10 I0 J10 F9", {10, 10, 0}, {0, 10, 0}, kZ, -1.5 * kPi},
    {"G21 G0 X0 Y0 Z0\nG2 I5 F9", {0, 0, 0}, {5, 0, 0}, kZ, -2 * kPi},
    {"G21 G0 X1 Y1 Z0\nG3 X1 Y1 J-2 F9", {1, 1, 0}, {1, -1, 0}, kZ, 2 * kPi},
    {"G21 G0 X0 Y0 Z0\nG3 X10 I5 P1 F9", {10, 0, 0}, {5, 0, 0}, kZ, kPi},
    {"G21 G0 X0 Y0 Z0\nG3 X10 I5 F9\nX0 I-5", {0, 0, 0}, {5, 0, 0}, kZ, kPi},
    {"G21 G0 X0 Y0 Z3\nG3 X10 I5 Z-1 F9", {10, 0, -1}, {5, 0, 0}, kZ, kPi},
    {"G21 G0 X0 Y0 Z0\nG3 X10 I5 J0 K0 F9", {10, 0, 0}, {5, 0, 0}, kZ, kPi},
    {"G20 G0 X0 Y0 Z0\nG3 X2 I1 F9", {50.8, 0, 0}, {25.4, 0, 0}, kZ, kPi},
    {"G21 G0 X1 Y1 Z0\nG91 G3 X10 I5 F9", {11, 1, 0}, {6, 1, 0}, kZ, kPi},
    {"G21 G0 X1 Y1 Z0\nG90.1 G3 X11 I6 J1 F9", {11, 1, 0}, {6, 1, 0}, kZ, kPi},
    {"G21 G0 X1 Y1 Z0\nG90.1\nG91.1 G3 X11 I5 F9", {11, 1, 0}, {6, 1, 0}, kZ, kPi},
    {"G21 G0 X0 Y0 Z0\nG3 X10 R10 F9", {10, 0, 0}, {5, kOff, 0}, kZ, kPi / 3},
    {"G21 G0 X0 Y0 Z0\nG2 X10 R10 F9", {10, 0, 0}, {5, -kOff, 0}, kZ, -kPi / 3},
    {"G21 G0 X0 Y0 Z0\nG3 X10 R-10 F9", {10, 0, 0}, {5, -kOff, 0}, kZ, 5 * kPi / 3},
    {"G21 G0 X0 Y0 Z0\nG2 X10 R-10 F9", {10, 0, 0}, {5, kOff, 0}, kZ, -5 * kPi / 3},
    {"G21 G0 X0 Y0 Z0\nG2 X10 R5 F9", {10, 0, 0}, {5, 0, 0}, kZ, -kPi},
    // From X+ to Z+: seen from +Y, Z points right and X up, so this is clockwise.
    {"G21 G18 G0 X5 Y0 Z0\nG2 X0 Z5 I-5 K0 F9", {0, 0, 5}, {0, 0, 0}, kY, -kPi / 2},
    {"G21 G18 G0 X0 Y0 Z5\nG3 X5 Z0 K-5 F9", {5, 0, 0}, {0, 0, 0}, kY, kPi / 2},
    {"G21 G18 G0 X0 Y1 Z0\nG3 Z10 R10 F9", {0, 1, 10}, {kOff, 1, 5}, kY, kPi / 3},
    {"G21 G18 G0 X0 Y1 Z5\nG3 X5 Z0 K-5 Y7 F9", {5, 7, 0}, {0, 1, 0}, kY, kPi / 2},
    // From Y+ to Z+: seen from +X, Y points right and Z up: counter-clockwise.
    {"G21 G19 G0 X2 Y5 Z0\nG3 Y0 Z5 J-5 F9", {2, 0, 5}, {2, 0, 0}, kX, kPi / 2},
    {"G21 G19 G0 X2 Y0 Z5\nG2 Y5 Z0 K-5 F9", {2, 5, 0}, {2, 0, 0}, kX, -kPi / 2}};

TEST(LastArc, IsThisOne) {
  for (const ArcCase& test : kLastArcRows) {
    SCOPED_TRACE(test.text);
    const Interpreted it(test.text);
    ASSERT_FALSE(it.read.motions.empty());
    ASSERT_EQ(it.read.motions.back().kind, MotionKind::kArc);
    const geometry::Arc arc = *it.read.motions.back().piece.arc();
    EXPECT_LT((arc.end - test.end).norm(), 1e-9);
    EXPECT_LT((arc.axis - test.axis).norm(), 1e-15);
    const Vector3 off = arc.center - test.center;
    EXPECT_LT((off - off.dot(arc.axis) * arc.axis).norm(), 1e-9);
    EXPECT_NEAR(arc.sweep, test.sweep, 1e-9);
  }
}

// Both limits of the radii: 0.0283 mm, or 0.1 % of the radius, never above 0.5 mm.
TEST(InterpreterArcs, RefusesCentresThatAreTooFarOff) {
  const auto refused = [](double radius, double difference) {
    ArcWords words;
    words.end = Point3(2 * radius + difference, 0, 0);
    words.center[0] = radius;
    return arc_from_words(words).problem == "arc-radius-mismatch";
  };
  EXPECT_FALSE(refused(10, 0.0282));
  EXPECT_TRUE(refused(10, 0.0284));
  EXPECT_TRUE(refused(10, -0.0284));
  EXPECT_FALSE(refused(100, 0.0999));
  EXPECT_TRUE(refused(100, 0.1001));
  EXPECT_FALSE(refused(10000, 0.499));
  EXPECT_TRUE(refused(10000, 0.501));
}

TEST(InterpreterArcs, TakesAHalfChordThatRoundingMadeLongerThanTheRadius) {
  const auto taken = [](double radius) {
    ArcWords words;
    words.end = Point3(10, 0, 0);
    words.radius = radius;
    return arc_from_words(words).arc.has_value();
  };
  EXPECT_TRUE(taken(4.999));    // LinuxCNC takes it
  EXPECT_FALSE(taken(4.9975));  // and refuses this
}

struct NoArcCase {
  const char* text;
  std::string_view barrier;
};

const NoArcCase kNotAnArcRows[] = {{"G3 X10 I5 P2", reason::kNotUnderstood},
                                   {"G3 X10 I5 K1", reason::kArc},
                                   {"G3 X0 Y0 R5", reason::kArc},
                                   {"G3 I0 J0", reason::kArc},
                                   {"G90.1 G3 X10 I5", reason::kArc},
                                   {"G3 X10 I#1", reason::kExpression}};

TEST(NotAnArc, IsOpaqueAndLosesThePlace) {
  for (const NoArcCase& test : kNotAnArcRows) {
    SCOPED_TRACE(test.text);
    const Interpreted it(std::string("G21 G0 X0 Y0 Z0\nF9\n") + test.text + "\nG1 X50\n");
    EXPECT_EQ(it.line(3).kind, BlockKind::kOpaque);
    EXPECT_EQ(it.line(3).barrier, test.barrier);
    EXPECT_EQ(it.motion_of_line(3), nullptr);
    ASSERT_NE(it.motion_of_line(4), nullptr);
    EXPECT_FALSE(it.motion_of_line(4)->start_known);
  }
}

// NUM and Philips. Read the other way the same words are another arc, or none.
TEST(InterpreterArcs, TakesCentresForPlacesUnderG90WhereTheControlDoes) {
  const auto centre_of = [](const std::string& arc, bool follow) {
    const Interpreted it("G21 G0 X10 Y0 Z0\n" + arc, {.centers_follow_distance = follow});
    const Motion* motion = it.motion_of_line(it.read.blocks.size());
    const bool is_arc = motion != nullptr && motion->kind == MotionKind::kArc;
    return is_arc ? std::optional(it.read.motions.back().piece.arc()->center.head<2>().eval())
                  : std::nullopt;
  };
  EXPECT_EQ(centre_of("G3 X-10 I0 J0 F9", true), Eigen::Vector2d(0, 0));
  EXPECT_FALSE(centre_of("G3 X-10 I0 J0 F9", false).has_value());
  EXPECT_EQ(centre_of("G91\nG3 X-20 I-10 F9", true), Eigen::Vector2d(0, 0));
  EXPECT_EQ(centre_of("G91\nG90 G3 X-10 I0 J0 F9", true), Eigen::Vector2d(0, 0));
  const std::string modes =
      "G21 G17 G94 G64 G40\nG49 G69\nG50\nG50.1\nG15\nG13.1\nG7.1 C0\nG5.1 Q0\nG67\nG97\nG8\n";
  const std::string cut = "G0 X10 Y0 Z0\nG3 X-10 I0 J0 F9";
  EXPECT_EQ(centre_of("G777\nG90\n" + modes + cut, true), Eigen::Vector2d(0, 0));
  EXPECT_FALSE(centre_of("G777\n" + modes + cut, true).has_value());
}

TEST(InterpreterArcs, NeedsTheStartInItsPlane) {
  const Interpreted it("G21\nG1 Z0 Y0 F9\nG3 X10 Y0 I5\nG1 X20\n");
  EXPECT_EQ(it.line(3).kind, BlockKind::kOpaque);
  EXPECT_EQ(it.line(3).barrier, reason::kPositionUnknown);
  EXPECT_TRUE(it.motion_of_line(4)->start_known);  // where it ends is said in full
}

TEST(InterpreterArcs, HelixFromAnUnknownHeightHasAnUnknownStart) {
  const Interpreted it("G21\nG1 X0 Y0 F9\nG3 X10 Y0 I5 Z-1\nG1 Z0\n");
  EXPECT_FALSE(it.motion_of_line(3)->start_known);
  EXPECT_TRUE(it.motion_of_line(4)->start_known);
}

}  // namespace
}  // namespace batten::gcode
