#include "geometry/band/band_region.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/path/joined_curve.h"
#include "tests/support/paths.h"

namespace batten::geometry::region {
namespace {

constexpr double kTolerance = 0.01;

bool holds(const Path& before, const Path& after, double tolerance = kTolerance) {
  const auto found = check_in_region(before, after, tolerance);
  EXPECT_TRUE(found.has_value());
  return found && found->holds();
}

bool holds_both_ways(const Path& before, const Path& after) {
  return holds(before, after) && holds(after, before);
}

Path chain(const std::vector<Point2>& points, double z = 0) {
  std::vector<Point3> in_space;
  for (const Point2& p : points) in_space.emplace_back(p.x(), p.y(), z);
  return path_through(in_space);
}

// A walk of steps about as long as the tolerance, so that the band lies over itself.
std::vector<Point3> random_walk(std::mt19937& random) {
  std::uniform_real_distribution<double> angle(-1.2, 1.2);
  std::uniform_real_distribution<double> step(0.3 * kTolerance, 8 * kTolerance);
  std::uniform_int_distribution<int> count(2, 25);
  std::vector<Point3> points = {Point3::Zero()};
  double direction = 0;
  for (int i = count(random); i > 0; --i) {
    direction += angle(random);
    points.push_back(points.back() +
                     step(random) * Vector3(std::cos(direction), std::sin(direction), 0));
  }
  return points;
}

Vector3 random_shift(std::mt19937& random, double most) {
  std::uniform_real_distribution<double> share(0, 1);
  const double angle = 2 * std::numbers::pi * share(random);
  return most * share(random) * Vector3(std::cos(angle), std::sin(angle), 0);
}

int pairs_to_try() {
  const char* given = std::getenv("BATTEN_PAIRS");
  return given != nullptr ? std::stoi(given) : 60;
}

// --- beside the distance -------------------------------------------------------------------------

// What is proved by the distance lies in the region; what leaves the region is not proved.
TEST(BandRegion, AgreesWithTheDistanceOfRandomPaths) {
  std::mt19937 random(7);
  int proved = 0;
  int left = 0;
  for (int i = 0; i < pairs_to_try(); ++i) {
    const std::vector<Point3> old_points = random_walk(random);
    std::vector<Point3> new_points;
    const double most = (i % 2 == 0 ? 0.98 : 1.6) * kTolerance;
    for (const Point3& point : old_points) {
      new_points.push_back(point + random_shift(random, most));
      if (random() % 4 == 0) new_points.push_back(new_points.back() + random_shift(random, 1e-3));
    }
    const Path before = path_through(old_points);
    const Path after = path_through(new_points);
    if (before.empty() || after.empty()) continue;
    const bool is_near = compare_paths(before, after, kTolerance).verdict == Verdict::kProved;
    const bool is_there = holds_both_ways(before, after);
    proved += is_near;
    left += !is_there;
    ASSERT_TRUE(is_there || !is_near) << "pair " << i;
  }
  EXPECT_GT(proved, pairs_to_try() / 4);
  EXPECT_GT(left, pairs_to_try() / 10);
}

TEST(BandRegion, TakesArcsAndCurvesForChords) {
  const Path arc = {Arc{{10, 0, 2}, {0, 10, 2}, {0, 0, 2}, Vector3::UnitZ(), std::numbers::pi / 2}};
  std::vector<Point3> points = arc_path(10, std::numbers::pi / 2, 40);
  for (Point3& point : points) point.z() = 2;
  EXPECT_TRUE(holds_both_ways(arc, path_through(points)));
  for (Point3& point : points) point *= 1.0015;
  for (Point3& point : points) point.z() = 2;
  EXPECT_FALSE(holds(arc, path_through(points)));
}

// All but as far off as is allowed, where both are cut into chords, at other angles.
TEST(BandRegion, HasRoomForTheChordsOfBoth) {
  const auto at = [](double r, double angle) {
    return Point3(r * std::cos(angle), r * std::sin(angle), 0);
  };
  const auto arc = [&](double r, double from, double to) {
    return Arc{at(r, from), at(r, to), Point3::Zero(), Vector3::UnitZ(), to - from};
  };
  for (const double off : {-0.995 * kTolerance, 0.995 * kTolerance}) {
    const Path before = {arc(10, 0, 1.5)};
    const Path after = {arc(10 + off, 0, 0.61), arc(10 + off, 0.61, 1.5)};
    EXPECT_TRUE(holds_both_ways(before, after)) << off;
  }
}

// --- what is wrong -------------------------------------------------------------------------------

TEST(BandRegion, SaysWhereAPathLeavesIt) {
  const Path line = chain({{0, 0}, {5, 0}, {10, 0}});
  EXPECT_TRUE(holds(line, chain({{0, 0}, {5, 0.0099}, {10, 0}})));
  const auto found = check_in_region(line, chain({{0, 0}, {4, 0.001}, {5, 0.012}, {10, 0}}), 0.01);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->is_inside);
  EXPECT_NEAR(found->place.x(), 4, 1e-9);
  EXPECT_FALSE(holds(line, chain({{0, 0.02}, {10, 0}})));
}

// The other end of a slot with a thin wall is cut off: in the region of the old path, but the old
// one is not in that of the new one.
TEST(BandRegion, FindsAWayThroughAThinWall) {
  const Path slot = chain({{0, 0}, {10, 0}, {10, 0.015}, {0, 0.015}});
  const Path through = chain({{0, 0}, {5, 0}, {5, 0.015}, {0, 0.015}});
  EXPECT_TRUE(holds(slot, through));
  EXPECT_FALSE(holds(through, slot));
}

// Over, back below, over again; the new path begins below. Each lies in the region of the other.
TEST(BandRegion, FindsTheWrongSideOfAnIsland) {
  const Point2 a(-1, 0);
  const Point2 b(1, 0);
  const Point2 above(0, 0.5);
  const Point2 below(0, -0.5);
  const Path before = chain({a, above, b, below, a, above, b});
  const Path after = chain({a, below, b, below, a, above, b});
  const auto found = check_in_region(before, after, kTolerance);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->holes, 1U);
  EXPECT_TRUE(found->is_inside);
  EXPECT_FALSE(found->passes_alike);
  EXPECT_TRUE(holds(before, before));
}

// --- where it says nothing -----------------------------------------------------------------------

TEST(BandRegion, IsOfFlatPathsInEachPlane) {
  const std::vector<Point2> bend = {{0, 0}, {5, 1}, {10, 0}};
  for (const int axis : {0, 1, 2}) {
    std::vector<Point3> points;
    for (const Point2& p : bend) {
      Point3 place = Point3::Constant(3);
      place[axis == 0 ? 1 : 0] = p.x();
      place[axis == 2 ? 1 : 2] = p.y();
      points.push_back(place);
    }
    const Path path = path_through(points);
    EXPECT_TRUE(holds(path, path));
    points[1][axis] += 0.001;
    EXPECT_FALSE(check_in_region(path, path_through(points), kTolerance));
    points[1][axis] -= 0.001;
    points[1][axis == 0 ? 1 : 0] += 0.5;
    const auto left = check_in_region(path, path_through(points), kTolerance);
    ASSERT_TRUE(left);
    EXPECT_FALSE(left->is_inside);
    EXPECT_EQ(left->place[axis], 3);
  }
  EXPECT_FALSE(check_in_region({}, chain(bend), kTolerance));
  EXPECT_THROW((void)check_in_region(chain(bend), chain(bend), 0), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry::region
