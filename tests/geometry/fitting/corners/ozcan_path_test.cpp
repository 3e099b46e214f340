#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <variant>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/fitting/corners/ozcan_corner.h"
#include "geometry/path/joined_curve.h"
#include "tests/support/corners.h"
#include "tests/support/method_cases.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

OzcanOptions with_tolerance(double tolerance, ToleranceKind kind) {
  OzcanOptions options;
  options.tolerance = tolerance;
  options.kind = kind;
  return options;
}

int blends_in(const OzcanPath& path) {
  return static_cast<int>(std::count_if(path.corners.begin(), path.corners.end(), [](auto& c) {
    return std::holds_alternative<OzcanBlend>(c.outcome);
  }));
}

// A path of many gentle turns and some sharp ones, in space.
std::vector<Point3> bent_path(unsigned seed, int segments) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> length(0.2, 3);
  std::vector<Point3> points = {Point3::Zero()};
  Vector3 direction(1, 0, 0);
  for (int i = 0; i < segments; ++i) {
    const double turn = i % 7 == 3 ? 1 : 0.03;
    const Vector3 aside(normal(random), normal(random), normal(random));
    direction = (direction + turn * aside).normalized();
    points.push_back(points.back() + length(random) * direction);
  }
  return points;
}

TEST(OzcanPath, GivesTheCornerOfOzcanAsTheCornerMethodDoes) {
  const std::vector<Point3> points = ozcan_corner_path();
  const OzcanOptions options = with_tolerance(0.1, ToleranceKind::kBand);
  const OzcanPath path = ozcan_path(points, options);
  ASSERT_EQ(path.corners.size(), 1u);
  const auto alone = ozcan_corner({points[0], points[1], points[2]}, 0.1, ToleranceKind::kBand);
  const auto& found = std::get<OzcanBlend>(path.corners[0].outcome);
  EXPECT_NEAR(found.feed_estimate, std::get<OzcanBlend>(alone).feed_estimate, 1e-9);
  EXPECT_EQ(path.searched, 1);
}

TEST(OzcanPath, StaysWithinTheToleranceInOrder) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::vector<Point3> points = bent_path(seed, 15);
    const OzcanPath path = ozcan_path(points, with_tolerance(0.02, ToleranceKind::kPath));
    EXPECT_GT(blends_in(path), 10);
    const PathComparison proof = compare_paths(path_through(points), path.pieces, 0.0206);
    EXPECT_EQ(proof.verdict, Verdict::kProved) << proof.bounds.at_most;
  }
}

// The star's corners are of two kinds in ten directions; a square's legs have four.
TEST(OzcanPath, SearchesCornersThatAreAlikeOnce) {
  std::vector<Point3> stairs = {Point3::Zero()};
  for (int i = 0; i < 40; ++i) {
    stairs.push_back(stairs.back() + (i % 2 ? Vector3(0, 2, 0) : Vector3(2, 0, 0)));
  }
  const OzcanPath path = ozcan_path(stairs, with_tolerance(0.05, ToleranceKind::kPath));
  EXPECT_EQ(blends_in(path), 39);
  EXPECT_EQ(path.searched, 2) << "to the left and to the right";
}

// Corners of printed programs are alike to their last digit, and those that only look alike are
// measured, which shows as another blend.
TEST(OzcanPath, TakesCornersAsAlikeToAMillionth) {
  for (const auto& [off, searched] : {std::pair{1e-8, 1}, {1e-3, 2}}) {
    const std::vector<Point3> points = {
        {0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {4, 2, 0}, {4 + off, 4, 0}};
    const OzcanPath path = ozcan_path(points, with_tolerance(0.05, ToleranceKind::kPath));
    EXPECT_EQ(path.searched, 1 + searched) << off;
  }
}

TEST(OzcanPath, SearchesNoGentleCorner) {
  std::vector<Point3> ring;
  for (int i = 0; i <= 360; ++i) {
    const double angle = i * std::numbers::pi / 180;
    ring.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), 0);
  }
  const OzcanPath path = ozcan_path(ring, with_tolerance(0.01, ToleranceKind::kPath));
  EXPECT_EQ(path.searched, 0);
  EXPECT_EQ(blends_in(path), 359);
}

TEST(OzcanPath, LeavesCornersWithoutRoom) {
  const std::vector<Point3> points = {{1.5e-9, 0, 0}, {0, 0, 0}, {0, 1, 0}};
  const OzcanPath path = ozcan_path(points, with_tolerance(0.01, ToleranceKind::kPath));
  ASSERT_EQ(path.corners.size(), 1u);
  EXPECT_EQ(std::get<NoBlend>(path.corners[0].outcome), NoBlend::kNoRoom);
}

// Stations are lengths along the polyline, so lines run at unit speed and the curve of the
// pieces passes each vertex's station near the vertex.
TEST(OzcanPath, HasTheStationOfEachVertexBesideIt) {
  const std::vector<Point3> points = bent_path(3, 12);
  const OzcanPath path = ozcan_path(points, with_tolerance(0.02, ToleranceKind::kPath));
  ASSERT_EQ(path.stations.size(), path.pieces.size() + 1);
  const BsplineCurve curve = curve_of_pieces(path.pieces, path.stations);
  double station = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) station += (points[i] - points[i - 1]).norm();
    EXPECT_LE((curve.point_at(station) - points[i]).norm(), 0.0205) << i;
  }
  EXPECT_NEAR(curve.last(), station, 1e-12);
}

}  // namespace
}  // namespace batten::geometry
