// Places that two paths pass, between which they may be compared for themselves.
#include "geometry/distance/joints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "geometry/distance/path_distance.h"
#include "geometry/path/path.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

// The vertices between the edges of a chain of lines.
PassedPlaces passed(const std::vector<Point3>& points) {
  PassedPlaces places;
  double length = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    length += (points[i] - points[i - 1]).norm();
    places.lengths.push_back(length);
  }
  places.place_at = [points](std::size_t i) { return points[i + 1]; };
  return places;
}

// A wave, moved aside by less than `off` but for each `kept`-th vertex.
std::vector<Point3> wave(std::size_t points, double off, std::size_t kept, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> aside(-off, off);
  std::vector<Point3> places;
  for (std::size_t i = 0; i < points; ++i) {
    const double x = 0.1 * static_cast<double>(i);
    const double moved = i % kept == 0 || i + 1 == points ? 0 : aside(random);
    places.emplace_back(x, std::sin(x) + moved, 0);
  }
  return places;
}

TEST(Joints, AreThePlacesThatBothPassSoFarApart) {
  const std::vector<Point3> a = wave(1001, 0, 50, 1);
  const std::vector<Point3> b = wave(1001, 0.01, 50, 2);
  std::size_t before = 0;
  const auto joints = joints_of(passed(a), passed(b), 120);
  ASSERT_EQ(joints.size(), 6U);
  for (const Joint& joint : joints) {
    EXPECT_EQ(a[joint.a], b[joint.b]);
    EXPECT_GE(joint.a - before, 120U);
    before = joint.a;
  }
}

// The distance of the wholes is that of the farthest parts, or less.
TEST(Joints, PartPathsThatKeepTheirDistance) {
  constexpr double kTolerance = 0.02;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const std::vector<Point3> a = wave(401, 0.005, 30, seed);
    const std::vector<Point3> b = wave(401, 0.005, 30, seed + 100);
    auto joints = joints_of(passed(a), passed(b), 40);
    EXPECT_GE(joints.size(), 5U);
    joints.push_back({a.size() - 1, b.size() - 1});
    double farthest = 0;
    Joint from;
    for (const Joint& to : joints) {
      const Path part_a = path_through({a.begin() + static_cast<std::ptrdiff_t>(from.a),
                                        a.begin() + static_cast<std::ptrdiff_t>(to.a + 1)});
      const Path part_b = path_through({b.begin() + static_cast<std::ptrdiff_t>(from.b),
                                        b.begin() + static_cast<std::ptrdiff_t>(to.b + 1)});
      const PathComparison part = compare_paths(part_a, part_b, kTolerance);
      EXPECT_EQ(part.verdict, Verdict::kProved);
      farthest = std::max(farthest, part.bounds.at_most);
      from = to;
    }
    const PathComparison whole = compare_paths(path_through(a), path_through(b), kTolerance);
    EXPECT_EQ(whole.verdict, Verdict::kProved);
    EXPECT_LE(whole.bounds.at_least, farthest);
  }
}

// A ring that is run twice passes each place twice.
TEST(Joints, AreNotALapApart) {
  std::vector<Point3> ring;
  for (int i = 0; i <= 200; ++i) {
    const double angle = 2 * std::acos(-1.0) * (i % 100) / 100;
    ring.emplace_back(std::cos(angle), std::sin(angle), 0);
  }
  std::vector<Point3> some_left_out = ring;
  some_left_out.erase(some_left_out.begin() + 16, some_left_out.begin() + 25);  // of the first lap
  const auto joints = joints_of(passed(some_left_out), passed(ring), 5);
  EXPECT_GE(joints.size(), 20U);
  for (const Joint& joint : joints) EXPECT_LE(joint.b - joint.a, 9U);
}

TEST(Joints, AreNotWhereAPathHasAGap) {
  PassedPlaces a = passed(wave(101, 0, 1, 1));
  const PassedPlaces b = a;
  EXPECT_EQ(joints_of(a, b, 10).size(), 9U);
  a.place_at = [](std::size_t) {
    return Point3::Constant(std::numeric_limits<double>::quiet_NaN()).eval();
  };
  EXPECT_TRUE(joints_of(a, b, 10).empty());
  EXPECT_TRUE(joints_of({}, b, 10).empty());
}

}  // namespace
}  // namespace batten::geometry
