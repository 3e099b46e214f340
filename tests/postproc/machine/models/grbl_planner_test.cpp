// grbl's planner in cases that have a closed form: a long line, one corner, the window of the
// planner, the line that feeds it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "postproc/machine/models/cycle_time.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

using gcode::PathMode;
using geometry::Line;
using geometry::Point3;
using std::numbers::pi;

constexpr double kAcceleration = 250;  // mm/s^2 of each axis
constexpr double kVelocity = 80;       // mm/s of each axis

Machine router() {
  Machine m;
  m.name = "router";
  m.model = ControllerModel::kGrbl;
  set_max_velocity(m, kVelocity);
  set_rapid_velocity(m, kVelocity);
  set_max_acceleration(m, kAcceleration);
  m.junction_deviation = 0.012;
  m.arc_tolerance = 0.002;
  m.block_period = 1e-9;  // nothing that feeds it is a limit here
  m.look_ahead = 15;
  return m;
}

double time_of(const std::vector<TimedPiece>& pieces, const Machine& m) {
  return cutting_time(pieces, m, PathMode::kBlending);
}

TEST(GrblPlanner, RunsOneLongLineAsATrapezoid) {
  const double v = 50;
  const double length = 130;
  const double expected = 2 * v / kAcceleration + (length - v * v / kAcceleration) / v;
  EXPECT_NEAR(time_of({{Line{{0, 0, 0}, {length, 0, 0}}, v * 60}}, router()), expected, 1e-6);
}

// A feed above what the axes can: along (3, 4) the Y axis has 4/5 of the speed.
TEST(GrblPlanner, LimitsALineByItsSlowestAxis) {
  const double v = kVelocity / 0.8;
  const double a = kAcceleration / 0.8;
  const double length = 200;
  const double expected = 2 * v / a + (length - v * v / a) / v;
  EXPECT_NEAR(time_of({{Line{{0, 0, 0}, {120, 160, 0}}, 60000}}, router()), expected, 1e-6);
}

// A corner that turns by `turn`: v^2 = a d sin(t/2) / (1 - sin(t/2)) with t the angle between the
// lines, and a the acceleration along the change of direction.
class GrblCorner : public testing::TestWithParam<int> {};

TEST_P(GrblCorner, IsPassedAtItsJunctionSpeed) {
  const double turn = GetParam() * pi / 180;
  const Machine m = router();
  const double sin_half = std::cos(turn / 2);
  // From (1, 0) to (cos, sin): the change is along (cos - 1, sin), normalised; the first line
  // runs along X, the second in the plane.
  const double cx = std::abs(std::cos(turn) - 1);
  const double sy = std::abs(std::sin(turn));
  const double norm = std::hypot(cx, sy);
  const double corner_acceleration = kAcceleration / (std::max(cx, sy) / norm);
  const double junction =
      std::sqrt(corner_acceleration * m.junction_deviation * sin_half / (1 - sin_half));
  const double feed = 40;  // mm/s
  const double corner = std::min(junction, feed);
  const double along = std::max(std::abs(std::cos(turn)), std::abs(std::sin(turn)));
  const auto side = [&](double a, double length) {
    const double up = feed * feed / (2 * a);
    const double down = (feed * feed - corner * corner) / (2 * a);
    return feed / a + (feed - corner) / a + (length - up - down) / feed;
  };
  const Point3 tip(30, 0, 0);
  const Point3 end = tip + 30 * Point3(std::cos(turn), std::sin(turn), 0);
  EXPECT_NEAR(time_of({{Line{{0, 0, 0}, tip}, feed * 60}, {Line{tip, end}, feed * 60}}, m),
              side(kAcceleration, 30) + side(kAcceleration / along, 30), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(GrblPlanner, GrblCorner, testing::Values(2, 10, 30, 45, 60, 90, 120, 150),
                         [](const auto& test) { return "Turn" + std::to_string(test.param); });

// The planner holds 15 blocks, the one that runs among them, and must be able to stop at the end
// of the last: behind a block there are 14 of length L, so its end is passed at
// sqrt(2 a 14 L) at most. Each block starts and ends at that speed; in between it speeds up and
// slows down again. The first 14 and the last 14 blocks are one ramp each.
TEST(GrblPlanner, BrakesForTheEndOfItsSixteenBlocks) {
  constexpr double kLength = 0.1;
  constexpr int kBlocks = 500;
  constexpr int kAhead = 14;
  std::vector<TimedPiece> blocks;
  for (int i = 0; i < kBlocks; ++i) {
    blocks.push_back({Line{{kLength * i, 0, 0}, {kLength * (i + 1), 0, 0}}, 60000});
  }
  const double window = std::sqrt(2 * kAcceleration * kAhead * kLength);
  const double peak = std::sqrt(window * window + kAcceleration * kLength);
  const double expected =
      2 * window / kAcceleration + (kBlocks - 2 * kAhead) * 2 * (peak - window) / kAcceleration;
  EXPECT_NEAR(time_of(blocks, router()), expected, 1e-6);
}

// Twice as many blocks for the same line: the window is half as long, the speed 1 / sqrt(2).
TEST(GrblPlanner, LosesSpeedWithTheLengthOfItsBlocks) {
  const auto time = [](double length) {
    std::vector<TimedPiece> blocks;
    for (int i = 0; i < 100 / length; ++i) {
      blocks.push_back({Line{{length * i, 0, 0}, {length * (i + 1), 0, 0}}, 60000});
    }
    return time_of(blocks, router());
  };
  EXPECT_NEAR(time(0.05) / time(0.1), std::sqrt(2.0), 0.03);
}

}  // namespace
}  // namespace batten::postproc
