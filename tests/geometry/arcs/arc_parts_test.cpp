#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "geometry/arcs/biarc.h"

namespace batten::geometry {
namespace {

using std::numbers::pi;
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
