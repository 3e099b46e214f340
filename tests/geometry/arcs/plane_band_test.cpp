#include "geometry/arcs/plane_band.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace batten::geometry {
namespace {

using std::numbers::pi;
constexpr double kTolerance = 0.01;
constexpr ArcSides kSides{kTolerance, kTolerance};

PlaneBand::Limits limits() { return {kTolerance, kTolerance, 1 / 0.05, 3.0}; }

// Points of a circle about the origin, from (radius, 0) counter-clockwise.
std::vector<Point2> on_circle(double radius, int count, double angle) {
  std::vector<Point2> points;
  for (int i = 0; i <= count; ++i) points.push_back(radius * unit_vector(angle * i / count));
  return points;
}

PlaneArc arc_about_origin(double radius, double sweep) {
  return {{radius, 0}, radius * unit_vector(sweep), {0, 0}, radius, sweep};
}

TEST(PlaneBand, SamplesHoldEveryVertexInOrder) {
  const std::vector<Point2> points = {{0, 0}, {1, 0}, {1, 1}, {1.001, 1.5}, {30, 1.5}};
  const PlaneBand band(points, limits());
  std::size_t found = 0;
  double station = -1;
  for (const PlaneBand::Sample& sample : band.samples()) {
    EXPECT_GT(sample.station, station);
    station = sample.station;
    if (found < points.size() && sample.place == points[found]) ++found;
  }
  EXPECT_EQ(found, points.size());
}

// From a tangent on a straight line of length L, arcs of curvature up to 2 e / L^2 stay within e
// at its end (to first order in e / L).
TEST(PlaneBand, TheFanOnALineClosesWithTheSquareOfTheLength) {
  std::vector<Point2> points;
  for (int i = 0; i <= 100; ++i) points.push_back({0.1 * i, 0});
  const PlaneBand band(points, limits());
  const ArcFan fan = band.fan({{0, 0}, {1, 0}, 1});
  ASSERT_EQ(fan.size(), band.samples().size() - 1);
  for (const std::size_t i : {49UL, fan.size() - 1}) {
    const double length = band.samples()[i + 1].station;
    const double expected = 2 * kTolerance / (length * length);
    EXPECT_NEAR(fan[i].high, expected, 0.05 * expected);
    EXPECT_NEAR(fan[i].low, -expected, 0.05 * expected);
  }
}

TEST(PlaneBand, TheFanHoldsTheCircleThatTheVerticesLieOn) {
  const PlaneBand band(on_circle(20, 200, 2.5), limits());
  const ArcFan fan = band.fan({{20, 0}, {0, 1}, 1});
  ASSERT_EQ(fan.size(), band.samples().size() - 1);
  EXPECT_LT(fan.back().low, 1.0 / 20);
  EXPECT_GT(fan.back().high, 1.0 / 20);
}

TEST(PlaneBand, ReachEndsAtACorner) {
  const std::vector<Point2> points = {{0, 0}, {5, 0}, {5, 5}};
  const PlaneBand band(points, limits());
  const ArcReach reach = band.reach({{0, 0}, {1, 0}, 1});
  ASSERT_LT(reach.end, band.samples().size());
  EXPECT_NEAR(band.samples()[reach.end].station, 5, 3 * kTolerance);
}

// The quick look skips samples: it ends at the fan's end or a few samples behind it.
TEST(PlaneBand, ReachIsTheEndOfTheFan) {
  std::vector<Point2> points;
  for (int i = 0; i <= 2000; ++i) {
    const double x = 0.05 * i;
    points.push_back({x, 3 * std::sin(0.4 * x) + 0.5 * std::sin(1.7 * x)});
  }
  PlaneBand::Limits strides = limits();
  strides.stride = 4;
  const PlaneBand band(points, strides);
  const PlaneBand exact(points, limits());
  const auto& samples = band.samples();
  for (std::size_t next = 1; next + 1 < samples.size(); next += 7) {
    for (const double off : {0.0, 0.004, -0.004}) {
      const Vector2& way = samples[next].edge_way;
      const double angle = std::atan2(way.y(), way.x()) + off;
      const BandEntry entry{samples[next - 1].place, unit_vector(angle), next};
      const std::size_t end = next + band.fan(entry).size();
      const std::size_t reach = band.reach(entry).end;
      EXPECT_GE(reach, end);
      EXPECT_LE(reach, end + 4);
      EXPECT_EQ(exact.reach(entry).end, end);
    }
  }
}

TEST(PlaneBand, MayReachWhateverItReaches) {
  std::vector<Point2> points;
  for (int i = 0; i <= 2000; ++i) {
    const double x = 0.05 * i;
    points.push_back({x, 3 * std::sin(0.4 * x) + 0.5 * std::sin(1.7 * x)});
  }
  const PlaneBand band(points, limits());
  const auto& samples = band.samples();
  int told = 0;
  for (std::size_t next = 1; next + 1 < samples.size(); next += 7) {
    const BandEntry entry{samples[next - 1].place, samples[next].edge_way, next};
    const std::size_t end = band.reach(entry).end;
    EXPECT_TRUE(band.may_reach(entry, end));
    EXPECT_TRUE(band.may_reach(entry, next));
    const std::size_t far = std::min(samples.size(), end + (end - next) / 4 + 2);
    if (far > end && !band.may_reach(entry, far)) ++told;
  }
  EXPECT_GT(told, 250);  // of 285
}

TEST(PlaneBand, AnArcWithinTheToleranceIsPassed) {
  const PlaneBand band(on_circle(20, 200, 2.5), limits());
  const double offs[] = {0, 0.0095, -0.0090};  // the chords' sagitta is 0.0004
  for (const double off : offs) {
    const double radius = 20 + off;
    const BandEntry entry{{radius, 0}, {0, 1}, 1};
    EXPECT_EQ(band.passed(entry, arc_about_origin(radius, 2.5), kSides), band.samples().size())
        << off;
  }
}

TEST(PlaneBand, AnArcThatGoesOnAtASampleIsPassedToTheNextOne) {
  const auto points = on_circle(20, 200, 2.5);
  const PlaneBand band(points, limits());
  const auto& samples = band.samples();
  const BandEntry entry{{20, 0}, {0, 1}, 1};
  for (std::size_t i = 40; i + 1 < samples.size(); i += 30) {
    const Point2& place = samples[i].place;
    const double at = std::atan2(place.y(), place.x());
    // Just before the sample it ends before it; at the sample and just after it, after it.
    EXPECT_EQ(band.passed(entry, arc_about_origin(20, at - 1e-6), kSides), i);
    EXPECT_EQ(band.passed(entry, arc_about_origin(20, at), kSides), i + 1);
    EXPECT_EQ(band.passed(entry, arc_about_origin(20, at + 1e-6), kSides), i + 1);
  }
}

TEST(PlaneBand, AnArcBeyondTheToleranceIsNot) {
  const PlaneBand band(on_circle(20, 200, 2.5), limits());
  for (const double off : {0.0102, -0.0102}) {
    const double radius = 20 + off;
    const BandEntry entry{{radius, 0}, {0, 1}, 1};
    EXPECT_FALSE(band.passed(entry, arc_about_origin(radius, 2.5), kSides)) << off;
  }
}

// What is farther from the centre may be less far off.
TEST(PlaneBand, ThePathMayBeOffByAnotherDistanceOnEachSide) {
  constexpr ArcSides kSome{0.004, kTolerance};
  for (const double turn : {1.0, -1.0}) {
    std::vector<Point2> points = on_circle(20, 200, 2.5);
    for (Point2& point : points) point.y() *= turn;
    PlaneBand::Limits some = limits();
    some.outside = kSome.outside;
    const PlaneBand band(points, some);
    for (const double off : {-0.0045, -0.0035, 0.009, 0.0105}) {
      const double radius = 20 + off;
      const BandEntry entry{{radius, 0}, {0, turn}, 1};
      const PlaneArc arc = arc_with_sweep(
          {radius, 0}, {radius * std::cos(2.5), turn * radius * std::sin(2.5)}, turn * 2.5, 1e4);
      const bool fits = -kSome.outside < off && off < kSome.inside;
      EXPECT_EQ(band.passed(entry, arc, kSome).has_value(), fits) << off << " " << turn;
      const ArcFan fan = band.fan(entry);
      const double curvature = turn / radius;
      const bool in_fan = fan.size() + 1 == band.samples().size() && fan.back().low <= curvature &&
                          curvature <= fan.back().high;
      EXPECT_EQ(in_fan, fits) << off << " " << turn;
    }
  }
}

TEST(PlaneBand, AnArcThatEndsHalfWayPassesWhatLiesBeforeIt) {
  const PlaneBand band(on_circle(20, 200, 2.5), limits());
  const auto passed = band.passed({{20, 0}, {0, 1}, 1}, arc_about_origin(20, 1.25), kSides);
  ASSERT_TRUE(passed);
  EXPECT_NEAR(band.samples()[*passed].station, 25, 0.3);
}

// The vertices of a tooth lie on the line, but the path goes there and back.
TEST(PlaneBand, ALineDoesNotPassAPathThatGoesBack) {
  const std::vector<Point2> points = {{0, 0}, {6, 0}, {5, 0.001}, {10, 0}};
  const PlaneBand band(points, limits());
  EXPECT_FALSE(band.passed({{0, 0}, {1, 0}, 1}, {{0, 0}, {10, 0}}, kSides));
}

// Half a circle over one straight edge: both ends are right, the middle is not.
TEST(PlaneBand, AnArcThatBulgesFromALongEdgeIsNotPassed) {
  const std::vector<Point2> points = {{0, 0}, {1, 0}};
  const PlaneBand band(points, limits());
  const PlaneArc arc = arc_with_sweep({0, 0}, {1, 0}, 0.2, 1e4);  // sagitta 0.025
  EXPECT_FALSE(band.passed({{0, 0}, unit_vector(-0.1), 1}, arc, kSides));
  const PlaneArc flat = arc_with_sweep({0, 0}, {1, 0}, 0.06, 1e4);  // sagitta 0.0075
  EXPECT_TRUE(band.passed({{0, 0}, unit_vector(-0.03), 1}, flat, kSides));
}

}  // namespace
}  // namespace batten::geometry
