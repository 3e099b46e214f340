#include "geometry/arcs/biarc.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace batten::geometry {
namespace {

using std::numbers::pi;
constexpr double kNoLimit = 1e9;

double angle_error(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

TEST(PlaneArc, TurnsLeftForPositiveSweep) {
  const PlaneArc arc = arc_with_sweep({1, 0}, {0, 1}, pi / 2, kNoLimit);
  EXPECT_NEAR(arc.center.norm(), 0, 1e-15);
  EXPECT_NEAR(arc.radius, 1, 1e-15);
  EXPECT_NEAR(angle_error(arc.start_angle(), pi / 2), 0, 1e-15);
  const PlaneArc right = arc_with_sweep({1, 0}, {0, 1}, -pi / 2, kNoLimit);
  EXPECT_NEAR((right.center - Point2(1, 1)).norm(), 0, 1e-15);
}

TEST(PlaneArc, MoreThanHalfATurnHasItsCenterOnTheOtherSide) {
  const PlaneArc arc = arc_with_sweep({1, 0}, {0, -1}, 3 * pi / 2, kNoLimit);
  EXPECT_NEAR(arc.center.norm(), 0, 1e-15);
  EXPECT_NEAR(arc.length(), 3 * pi / 2, 1e-14);
}

TEST(PlaneArc, IsALineWhereItIsFlatterThanTheGreatestRadius) {
  EXPECT_TRUE(arc_with_sweep({0, 0}, {1, 0}, 0.0099, 100).is_line());
  EXPECT_FALSE(arc_with_sweep({0, 0}, {1, 0}, 0.0101, 100).is_line());
  EXPECT_TRUE(arc_with_sweep({0, 0}, {1, 0}, 0, kNoLimit).is_line());
}

TEST(PlaneArc, LeavesAndArrivesAtTheGivenAngle) {
  const PlaneArc leaving = arc_leaving({2, 1}, 0.3, {5, 3}, kNoLimit);
  EXPECT_NEAR(angle_error(leaving.start_angle(), 0.3), 0, 1e-14);
  const PlaneArc arriving = arc_arriving({2, 1}, {5, 3}, 0.3, kNoLimit);
  EXPECT_NEAR(angle_error(arriving.start_angle() + arriving.sweep, 0.3), 0, 1e-14);
}

TEST(Biarc, AQuarterCircleIsTwoArcsOfItself) {
  const auto joint = biarc_joint({1, 0}, pi / 2, {0, 1}, pi, 1);
  ASSERT_TRUE(joint);
  EXPECT_NEAR((joint->place - Point2(std::sqrt(0.5), std::sqrt(0.5))).norm(), 0, 1e-15);
}

TEST(Biarc, ThreeQuartersOfACircleToo) {
  const auto joint = biarc_joint({1, 0}, pi / 2, {0, -1}, 2 * pi, 1);
  ASSERT_TRUE(joint);
  EXPECT_NEAR((joint->place + Point2(std::sqrt(0.5), -std::sqrt(0.5))).norm(), 0, 1e-14);
}

// Parallel tangents, one step aside: two arcs of opposite turn, through the middle.
TEST(Biarc, AStepAsideIsAnS) {
  const auto joint = biarc_joint({0, 0}, 0, {4, 1}, 0, 1);
  ASSERT_TRUE(joint);
  EXPECT_NEAR((joint->place - Point2(2, 0.5)).norm(), 0, 1e-15);
  EXPECT_GT(arc_leaving({0, 0}, 0, joint->place, kNoLimit).sweep, 0);
  EXPECT_LT(arc_arriving(joint->place, {4, 1}, 0, kNoLimit).sweep, 0);
}

TEST(Biarc, ArcsMeetWithOneTangentWhateverTheBalance) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int pairs = 0;
  for (int i = 0; i < 1000; ++i) {
    const Point2 end(3 + uniform(random), uniform(random));
    const double start_angle = uniform(random);
    const double end_angle = uniform(random);
    const double balance = std::exp(0.3 * uniform(random));
    const auto joint = biarc_joint({0, 0}, start_angle, end, end_angle, balance);
    if (!joint) continue;
    ++pairs;
    const PlaneArc first = arc_leaving({0, 0}, start_angle, joint->place, 1e12);
    const PlaneArc second = arc_arriving(joint->place, end, end_angle, 1e12);
    EXPECT_LT(angle_error(first.start_angle() + first.sweep, second.start_angle()), 1e-9);
  }
  EXPECT_GT(pairs, 900);
}

CubicBezier quarter_of_radius(double r) {  // off the circle by at most 2.73e-4 r, outwards
  const double handle = 4.0 / 3 * std::tan(pi / 8) * r;
  return {{{r, 0, 0}, {r, handle, 0}, {handle, r, 0}, {0, r, 0}}};
}

TEST(StaysNear, KnowsTheErrorOfACubicCircle) {
  const PlaneArc arc = arc_with_sweep({10, 0}, {0, 10}, pi / 2, kNoLimit);
  EXPECT_TRUE(stays_near(quarter_of_radius(10), arc, 2.74e-3));
  EXPECT_FALSE(stays_near(quarter_of_radius(10), arc, 2.70e-3));
}

TEST(StaysNear, RefusesTheWayBack) {
  CubicBezier back = quarter_of_radius(10);
  std::swap(back.control[0], back.control[3]);
  std::swap(back.control[1], back.control[2]);
  const PlaneArc arc = arc_with_sweep({10, 0}, {0, 10}, pi / 2, kNoLimit);
  EXPECT_FALSE(stays_near(back, arc, 1e-2));
  const PlaneArc line{{0, 0}, {3, 0}};
  EXPECT_FALSE(stays_near({{{3, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0, 0, 0}}}, line, 1e-2));
}

// (t, 4 h t (1 - t)) is h away from the line at t = 1/2.
TEST(StaysNear, MeasuresAcrossALine) {
  const double h = 0.01;
  const CubicBezier hump{{{0, 0, 0}, {1, 4 * h / 3, 7}, {2, 4 * h / 3, 7}, {3, 0, 7}}};
  const PlaneArc line{{0, 0}, {3, 0}};
  EXPECT_TRUE(stays_near(hump, line, h * 1.001));
  EXPECT_FALSE(stays_near(hump, line, h * 0.999));
}

}  // namespace
}  // namespace batten::geometry
