#include "geometry/fitting/fair/inner_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace batten::geometry {
namespace {

constexpr double kRadius = 1.5;
constexpr double kAngle = 0.15;  // of a chord
constexpr double kUnlimited = std::numeric_limits<double>::infinity();

std::vector<Point3> on_circle() {
  std::vector<Point3> points;
  for (int i = 0; i <= 60; ++i) {
    points.emplace_back(kRadius * std::cos(i * kAngle), kRadius * std::sin(i * kAngle), 0);
  }
  return points;
}

SmoothCurve curve_through(const std::vector<Point3>& points) {
  FairOptions options;
  options.tolerance = 0.02;
  options.accurate = true;
  return fair_path(points, options).value();
}

TEST(InnerPath, IsAThirdOfTheHeightOfChordsInsideOfACircle) {
  const std::vector<Point3> points = on_circle();
  const std::vector<Point3> moved = drawn_inwards(points, curve_through(points), kUnlimited);
  ASSERT_EQ(moved.size(), points.size());
  EXPECT_EQ(moved.front(), points.front());
  EXPECT_EQ(moved.back(), points.back());
  const double height = kRadius * (1 - std::cos(kAngle / 2));
  for (std::size_t i = 3; i + 3 < points.size(); ++i) {
    EXPECT_NEAR(kRadius - moved[i].norm(), height / 3, 0.03 * height) << i;
    EXPECT_NEAR(moved[i].normalized().dot(points[i].normalized()), 1, 1e-6) << i;
  }
}

// The circle through them is as long over each chord as the chord is.
TEST(InnerPath, IsAsLongAsTheChords) {
  const std::vector<Point3> points = on_circle();
  const std::vector<Point3> moved = drawn_inwards(points, curve_through(points), kUnlimited);
  for (std::size_t i = 5; i + 5 < points.size(); ++i) {
    const double chord = (points[i + 1] - points[i]).norm();
    const double arc = kAngle * 0.5 * (moved[i].norm() + moved[i + 1].norm());
    EXPECT_NEAR(arc / chord, 1, 5e-5) << i;
    EXPECT_GT(kAngle * kRadius / chord, 1 + 9e-4) << i;
  }
}

TEST(InnerPath, IsNoFartherInsideThanItMayBe) {
  const std::vector<Point3> points = on_circle();
  const double most = 5e-4;
  const std::vector<Point3> moved = drawn_inwards(points, curve_through(points), most);
  for (std::size_t i = 3; i + 3 < points.size(); ++i) {
    EXPECT_NEAR((moved[i] - points[i]).norm(), most, 1e-12) << i;
  }
}

TEST(InnerPath, StaysOnStraightParts) {
  std::vector<Point3> points;
  for (int i = 0; i <= 20; ++i) points.emplace_back(0.4 * i, 0.3 * i, 0.1 * i);
  const std::vector<Point3> moved = drawn_inwards(points, curve_through(points), kUnlimited);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((moved[i] - points[i]).norm(), 1e-9) << i;
  }
}

}  // namespace
}  // namespace batten::geometry
