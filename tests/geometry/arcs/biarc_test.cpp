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

TEST(TurnBetween, IsTheAngleWhetherSmallOrNot) {
  for (const double angle : {0.0, 1e-9, -1e-4, 0.01, -0.1, 0.124, 0.126, -1.0, 1.6, -3.0}) {
    EXPECT_NEAR(turn_between(2 * unit_vector(0.7), 3 * unit_vector(0.7 + angle)), angle, 1e-15)
        << angle;
  }
}

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
  const PlaneArc leaving = arc_leaving({2, 1}, unit_vector(0.3), {5, 3}, kNoLimit);
  EXPECT_NEAR(angle_error(leaving.start_angle(), 0.3), 0, 1e-14);
  const PlaneArc arriving = arc_arriving({2, 1}, {5, 3}, unit_vector(0.3), kNoLimit);
  EXPECT_NEAR(angle_error(arriving.start_angle() + arriving.sweep, 0.3), 0, 1e-14);
}

TEST(Biarc, AQuarterCircleIsTwoArcsOfItself) {
  const auto joint = biarc_joint({1, 0}, {0, 1}, {0, 1}, {-1, 0}, 1);
  ASSERT_TRUE(joint);
  EXPECT_NEAR((joint->place - Point2(std::sqrt(0.5), std::sqrt(0.5))).norm(), 0, 1e-15);
}

TEST(Biarc, ThreeQuartersOfACircleToo) {
  const auto joint = biarc_joint({1, 0}, {0, 1}, {0, -1}, {1, 0}, 1);
  ASSERT_TRUE(joint);
  EXPECT_NEAR((joint->place + Point2(std::sqrt(0.5), -std::sqrt(0.5))).norm(), 0, 1e-14);
}

// Parallel tangents, one step aside: two arcs of opposite turn, through the middle.
TEST(Biarc, AStepAsideIsAnS) {
  const auto joint = biarc_joint({0, 0}, {1, 0}, {4, 1}, {1, 0}, 1);
  ASSERT_TRUE(joint);
  EXPECT_NEAR((joint->place - Point2(2, 0.5)).norm(), 0, 1e-15);
  EXPECT_GT(arc_leaving({0, 0}, {1, 0}, joint->place, kNoLimit).sweep, 0);
  EXPECT_LT(arc_arriving(joint->place, {4, 1}, {1, 0}, kNoLimit).sweep, 0);
}

TEST(Biarc, ArcsMeetWithOneTangentWhateverTheBalance) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int pairs = 0;
  for (int i = 0; i < 1000; ++i) {
    const Point2 end(3 + uniform(random), uniform(random));
    const Vector2 leaving = unit_vector(uniform(random));
    const Vector2 arriving = unit_vector(uniform(random));
    const double balance = std::exp(0.3 * uniform(random));
    const auto joint = biarc_joint({0, 0}, leaving, end, arriving, balance);
    if (!joint) continue;
    ++pairs;
    const PlaneArc first = arc_leaving({0, 0}, leaving, joint->place, 1e12);
    const PlaneArc second = arc_arriving(joint->place, end, arriving, 1e12);
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

// An arc in parts.

constexpr double kDegree = pi / 180;

// From `from` degrees by `sweep` degrees about (2, 3, z), radius 10, rising by `rise`.
Arc arc_of(double from, double sweep, double rise = 0) {
  const Point3 center(2, 3, 0);
  const auto place = [&](double degrees, double z) {
    return Point3(center.x() + 10 * std::cos(degrees * kDegree),
                  center.y() + 10 * std::sin(degrees * kDegree), z);
  };
  return {place(from, 0), place(from + sweep, rise), center, Vector3::UnitZ(), sweep * kDegree};
}

ArcPartsOptions at_most(double degrees) { return {degrees * kDegree, Vector3::Zero()}; }

TEST(ArcParts, OfAShortArcIsTheArcItself) {
  const Arc arc = arc_of(10, 89);
  const auto parts = arc_parts(arc, at_most(90));
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_EQ(parts[0].start, arc.start);
  EXPECT_EQ(parts[0].end, arc.end);
  EXPECT_EQ(parts[0].sweep, arc.sweep);
}

TEST(ArcParts, OfAFullTurnAreTwoHalves) {
  for (const double sweep : {360.0, -360.0}) {
    const auto parts = arc_parts(arc_of(30, sweep, 4), at_most(180));
    ASSERT_EQ(parts.size(), 2U);
    EXPECT_NEAR(parts[0].sweep, sweep / 2 * kDegree, 1e-12);
    EXPECT_NEAR((parts[0].end - arc_of(30, sweep / 2, 2).end).norm(), 0, 1e-9);
    EXPECT_EQ(parts[1].end, arc_of(30, sweep, 4).end);
  }
}

struct QuadrantCase {
  double from;
  double sweep;
  std::vector<double> ends;  // degrees, of all parts
};

// By hand: the directions are 0, 90, 180 and 270 degrees.
TEST(ArcParts, EndAtTheDirectionsOfTheQuadrants) {
  const QuadrantCase cases[] = {
      {10, 60, {70}},      {10, 100, {90, 110}},          {-30, 60, {0, 30}},
      {30, -60, {0, -30}}, {0, 360, {90, 180, 270, 360}}, {0, -180, {-90, -180}},
      {90, 90, {180}},     {45, -200, {0, -90, -155}},
  };
  for (const QuadrantCase& test : cases) {
    SCOPED_TRACE(testing::Message() << test.from << " by " << test.sweep);
    const auto parts = arc_parts(arc_of(test.from, test.sweep), {180 * kDegree, Vector3::UnitX()});
    ASSERT_EQ(parts.size(), test.ends.size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const Point3 expected = arc_of(0, test.ends[i]).end;
      EXPECT_NEAR((parts[i].end - expected).norm(), 0, 1e-9) << "part " << i;
    }
  }
}

TEST(ArcParts, ChainAndStayOnTheArc) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> angle(-360, 360);
  for (int i = 0; i < 300; ++i) {
    const double sweep = angle(random);
    if (std::abs(sweep) < 1) continue;
    const Arc arc = arc_of(angle(random), sweep, angle(random) / 100);
    ArcPartsOptions options = at_most(20 + std::abs(angle(random)) / 2);
    if (i % 2 == 0) options.quadrant_from = Vector3::UnitX();
    Point3 place = arc.start;
    double turned = 0;
    for (const Arc& part : arc_parts(arc, options)) {
      EXPECT_NEAR((part.start - place).norm(), 0, 1e-9);
      EXPECT_LE(std::abs(part.sweep), options.max_sweep + 1e-5);
      EXPECT_NEAR((part.end.head<2>() - arc.center.head<2>()).norm(), 10, 1e-9);
      place = part.end;
      turned += part.sweep;
    }
    EXPECT_EQ(place, arc.end);
    EXPECT_NEAR(turned, arc.sweep, 1e-9);
  }
}

}  // namespace
}  // namespace batten::geometry
