#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <variant>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/fitting/corners/time_optimal_corner.h"
#include "tests/support/method_cases.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

TimeOptimalPathOptions within(double tolerance, ToleranceKind kind = ToleranceKind::kPath) {
  TimeOptimalPathOptions options;
  options.tolerance = tolerance;
  options.kind = kind;
  return options;
}

int raced_in(const TimeOptimalPath& path) {
  return static_cast<int>(std::count_if(path.corners.begin(), path.corners.end(), [](auto& c) {
    const auto* blend = std::get_if<TimeOptimalPathBlend>(&c.outcome);
    return blend != nullptr && blend->raced;
  }));
}

std::vector<Point3> stairs(int steps, double length) {
  std::vector<Point3> points = {Point3::Zero()};
  for (int i = 0; i < steps; ++i) {
    points.push_back(points.back() + (i % 2 ? Vector3(0, length, 0) : Vector3(length, 0, 0)));
  }
  return points;
}

TEST(TimeOptimalPath, GivesOneCornerAsTheCornerMethodDoes) {
  const std::vector<Point3> points = ozcan_corner_path();
  const TimeOptimalPath path = time_optimal_path(points, within(0.1, ToleranceKind::kBand));
  ASSERT_EQ(path.corners.size(), 1u);
  TimeOptimalOptions alone;
  alone.tolerance = 0.1;
  alone.kind = ToleranceKind::kBand;
  alone.share_before = alone.share_after = 1e9;
  const auto corner = time_optimal_corner({points[0], points[1], points[2]}, alone);
  const auto& expected = std::get<TimeOptimalBlend>(corner).blend.curve.control_points();
  const auto& found = std::get<TimeOptimalPathBlend>(path.corners[0].outcome).blend.curve;
  ASSERT_EQ(found.control_points().size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_LT((found.control_points()[i] - expected[i]).norm(), 1e-9);
  }
}

TEST(TimeOptimalPath, StaysWithinTheToleranceInOrder) {
  for (const std::vector<Point3>& points : {star_path(), guo_hexagon(), stairs(12, 3)}) {
    const TimeOptimalPath path = time_optimal_path(points, within(0.05));
    EXPECT_EQ(raced_in(path), static_cast<int>(points.size()) - 2);
    const PathComparison proof = compare_paths(path_through(points), path.pieces, 0.0515);
    EXPECT_EQ(proof.verdict, Verdict::kProved) << proof.bounds.at_most;
    EXPECT_EQ(start_point(path.pieces.front()), points.front());
    EXPECT_EQ(end_point(path.pieces.back()), points.back());
  }
}

// To the left and to the right; and at both ends of the stairs once more, where a leg is no
// corner's but its own.
TEST(TimeOptimalPath, SearchesCornersThatAreAlikeOnce) {
  const TimeOptimalPath path = time_optimal_path(stairs(40, 2), within(0.05));
  EXPECT_EQ(raced_in(path), 39);
  EXPECT_LE(path.searched, 4);
}

// With legs far longer than the machine needs their length is no matter.
TEST(TimeOptimalPath, LongLegsOfAnyLengthAreAlike) {
  TimeOptimalPathOptions options = within(0.05);
  options.limits.jerk.setConstant(5e5);
  std::vector<Point3> points = {Point3::Zero()};
  for (int i = 0; i < 12; ++i) {
    const double length = 20 + i;
    points.push_back(points.back() + (i % 2 ? Vector3(0, length, 0) : Vector3(length, 0, 0)));
  }
  const TimeOptimalPath path = time_optimal_path(points, options);
  EXPECT_EQ(raced_in(path), 11);
  EXPECT_EQ(path.searched, 2);
}

TEST(TimeOptimalPath, GentleCornersAndThoseBeyondTheMostGetTheFivePoints) {
  std::vector<Point3> ring;
  for (int i = 0; i <= 360; ++i) {
    const double angle = i * std::numbers::pi / 180;
    ring.emplace_back(10 * std::cos(angle), 10 * std::sin(angle), 0);
  }
  const TimeOptimalPath gentle = time_optimal_path(ring, within(0.01));
  EXPECT_EQ(gentle.searched, 0);
  EXPECT_EQ(gentle.corners.size(), 359u);
  EXPECT_EQ(raced_in(gentle), 0);
  TimeOptimalPathOptions few = within(0.05);
  few.most_raced = 1;
  const TimeOptimalPath path = time_optimal_path(star_path(), few);
  EXPECT_EQ(path.searched, 1);
  EXPECT_LT(raced_in(path), 10);
  for (const auto& corner : path.corners) {
    EXPECT_TRUE(std::holds_alternative<TimeOptimalPathBlend>(corner.outcome));
  }
}

// Teeth of noise: room for a tenth of a millimetre, and the search finds nothing there.
TEST(TimeOptimalPath, TakesTheFivePointsWhereARacingLineWouldStandStill) {
  const std::vector<Point3> points = zigzag_line(20, 0.5, 0.03);
  const TimeOptimalPath path = time_optimal_path(points, within(0.05));
  for (const auto& corner : path.corners) {
    const auto* blend = std::get_if<TimeOptimalPathBlend>(&corner.outcome);
    if (blend == nullptr) continue;
    for (double u = blend->blend.curve.first(); u < blend->blend.curve.last();
         u += 0.013 * (blend->blend.curve.last() - blend->blend.curve.first())) {
      // The five points bend by 1.3 / mm there (docs/algorithms/methods.md).
      EXPECT_LE(blend->blend.curve.curvature_at(u), 4);
    }
  }
}

TEST(TimeOptimalPath, RefusesAToleranceThatIsNone) {
  EXPECT_THROW((void)time_optimal_path(star_path(), within(0)), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
