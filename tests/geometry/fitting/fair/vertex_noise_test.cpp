#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/fitting/fair/corner_test.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

std::vector<double> lengths_along(const std::vector<Point3>& points) {
  std::vector<double> s = {0};
  for (std::size_t i = 1; i < points.size(); ++i) {
    s.push_back(s.back() + (points[i] - points[i - 1]).norm());
  }
  return s;
}

std::vector<double> noise_of(const std::vector<Point3>& points) {
  return vertex_noise(points, lengths_along(points));
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

// A line or an arc of radius 40, a vertex per mm, each moved across the path by normal noise.
std::vector<Point3> noisy_path(bool arc, double deviation, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  std::vector<Point3> points;
  for (int i = 0; i < 200; ++i) {
    if (arc) {
      const double r = 40 + normal(random);
      points.emplace_back(r * std::cos(i / 40.0), r * std::sin(i / 40.0), 0);
    } else {
      points.emplace_back(i, normal(random), 0);
    }
  }
  return points;
}

TEST(VertexNoise, IsThatOfWhiteNoiseWithinThirtyPercent) {
  for (const bool arc : {false, true}) {
    for (const double deviation : {1e-5, 0.001, 0.03}) {
      for (unsigned seed = 1; seed <= 10; ++seed) {
        SCOPED_TRACE(testing::Message() << arc << " " << deviation << " seed " << seed);
        const double found = median(noise_of(noisy_path(arc, deviation, seed)));
        // A circle sampled once per mm leaves a cubic by 1e-7 mm: nothing beside the noise.
        EXPECT_NEAR(found, deviation, 0.3 * deviation);
      }
    }
  }
}

TEST(VertexNoise, IsNothingOnCleanSamplesOfSmoothCurves) {
  constexpr double kRounding = 1e-6;
  for (const auto& points :
       {arc_path(20, 3, 100), helix_path(20, 6, 2, 240), zigzag_line(100, 0.5, 0)}) {
    for (const double noise : noise_of(points)) EXPECT_LE(noise, kRounding);
  }
  std::vector<Point3> uneven;  // steps of 0.2 to 1.8 mm along a sine
  for (double x = 0; x < 80; x += 1 + 0.8 * std::sin(17 * x)) {
    uneven.emplace_back(x, 3 * std::sin(x / 12), 0);
  }
  for (const double noise : noise_of(uneven)) EXPECT_LE(noise, 1e-4);
}

TEST(VertexNoise, IsNotACornerThatStandsAlone) {
  for (const double turn : {0.1, 0.5, 1.5}) {
    std::vector<Point3> points;
    for (int i = -50; i <= 50; ++i) {
      const double angle = i <= 0 ? 0 : turn;
      points.emplace_back(i * std::cos(angle), i * std::sin(angle), 0);
    }
    for (const double noise : noise_of(points)) EXPECT_LE(noise, 1e-9) << turn;
  }
}

// Residuals against the cubic through (-1, 4, 4, -1) / 6 of the neighbours are 8/3 of the
// zig-zag's height; scaled to white noise they are divided by the root of 35/18, and the median
// of products by 0.36.
TEST(VertexNoise, CountsAZigzagThreeTimes) {
  const double expected = 0.03 * (8.0 / 3) / std::sqrt(35.0 / 18 * 0.36);
  const auto noise = noise_of(zigzag_line(100, 0.5, 0.03));
  EXPECT_NEAR(noise[100], expected, 0.01 * expected);
}

TEST(VertexNoise, FollowsAChangeAlongThePath) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, 0.01);
  std::vector<Point3> points;
  for (int i = 0; i < 200; ++i) points.emplace_back(i, i < 100 ? 0 : normal(random), 0);
  const auto noise = noise_of(points);
  EXPECT_LE(noise[60], 1e-9);
  EXPECT_GE(noise[140], 0.005);
}

TEST(VertexNoise, NeedsSixVertices) {
  const auto points = zigzag_line(2, 0.5, 0.03);
  ASSERT_EQ(points.size(), 5u);
  EXPECT_EQ(noise_of(points), std::vector<double>(5, 0.0));
  EXPECT_GT(noise_of(zigzag_line(2.5, 0.5, 0.03))[3], 0.0);
}

}  // namespace
}  // namespace batten::geometry
