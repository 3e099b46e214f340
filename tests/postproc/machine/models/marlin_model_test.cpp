// Marlin's rules for joints and arcs where they have a closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "postproc/machine/machine.h"
#include "postproc/machine/models/cycle_time.h"

namespace batten::postproc {
namespace {

using geometry::Line;
using geometry::Point3;

Machine marlin() {
  Machine m = *find_machine("marlin-router");
  m.block_period = 1e-6;
  m.stream_rate = Machine::kNone;
  for (AxisLimits& axis : m.axes) axis.steps = Machine::kNone;
  return m;
}

// mm/s at the joints inside.
std::vector<double> joint_limits(const std::vector<TimedPiece>& pieces, const Machine& m) {
  const StretchChain chain =
      stretches_of(pieces, m, gcode::PathMode::kBlending, ChainEnd::kStop, WithPositions::kNo);
  std::vector<double> limits;
  for (std::size_t i = 0; i + 1 < chain.stretches.size(); ++i) {
    limits.push_back(chain.stretches[i].exit_velocity);
  }
  return limits;
}

// Two moves of this length that turn by an angle in XY.
std::vector<TimedPiece> corner(double length, double turn) {
  const Point3 middle(length, 0, 0);
  const Point3 end = middle + length * Point3(std::cos(turn), std::sin(turn), 0);
  return {{Line{Point3::Zero(), middle}, 3000}, {Line{middle, end}, 3000}};
}

TEST(MarlinModel, PassesLongCornersByTheJunctionDeviation) {
  const double turn = 0.5;
  const double half = std::cos(turn / 2);
  const double along = 400 / std::max(std::abs(std::sin(turn / 2)), half);
  EXPECT_NEAR(joint_limits(corner(20, turn), marlin()).at(0),
              std::sqrt(along * 0.013 * half / (1 - half)), 1e-9);
}

// As on the circle that has such chords, where that is slower.
TEST(MarlinModel, PassesShortOnesNoFasterThanTheirCircle) {
  const double turn = 0.05;
  const double along = 400 / std::cos(turn / 2);
  EXPECT_NEAR(joint_limits(corner(0.2, turn), marlin()).at(0), std::sqrt(along * 0.2 / turn), 1e-6);
  EXPECT_GT(joint_limits(corner(1.01, turn), marlin()).at(0), std::sqrt(along * 1.01 / turn));
  Machine grbl = marlin();
  grbl.model = ControllerModel::kGrbl;
  EXPECT_GT(joint_limits(corner(0.2, turn), grbl).at(0), std::sqrt(along * 0.2 / turn));
}

TEST(MarlinModel, PassesJointsByTheStepsOfVelocityWhereItHasThem) {
  Machine m = marlin();
  for (AxisLimits& axis : m.axes) axis.velocity_step = 10;
  m.axis(Axis::kY).velocity_step = 4;
  EXPECT_NEAR(joint_limits(corner(20, std::numbers::pi / 2), m).at(0), 4, 1e-9);
  EXPECT_NEAR(joint_limits(corner(20, 0.1), m).at(0), 4 / std::sin(0.1), 1e-9);
  EXPECT_GT(joint_limits(corner(20, 0), m).at(0), 1e6);
}

TEST(MarlinModel, RunsArcsInChordsOfItsLength) {
  const auto chords = [](double radius) {
    const geometry::Arc quarter{
        {radius, 0, 0}, {0, radius, 0}, Point3::Zero(), {0, 0, 1}, std::numbers::pi / 2};
    return joint_limits({{quarter, 3000}}, marlin()).size() + 1;
  };
  EXPECT_EQ(chords(5), 18U);   // 72 in a circle
  EXPECT_EQ(chords(20), 31U);  // of 1 mm at the most
  EXPECT_EQ(chords(0.5), 7U);  // of 0.1 mm at the least
}

}  // namespace
}  // namespace batten::postproc
