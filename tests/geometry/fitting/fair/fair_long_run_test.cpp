// A long run is one fit, and still no place of it knows of what is far away.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "geometry/fitting/fair/fair.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

constexpr double kTolerance = 0.01;
constexpr std::size_t kFelt = 200;  // vertices on either side

std::vector<Point3> long_run(unsigned seed, double noise) {
  std::mt19937 random(seed);
  std::normal_distribution<double> off(0, noise);
  std::vector<Point3> points;
  for (int i = 0; i <= 6000; ++i) {
    const double x = 0.25 * i;
    const double z = 3 * std::sin(x / 6) + 0.8 * std::sin(x / 2.3) + (noise > 0 ? off(random) : 0);
    points.push_back(printed(Point3(x, 0, z), 3));
  }
  return points;
}

// Where a vertex is moved, the curve moves only beside it.
TEST(LongFairPath, AVertexIsFeltOverTwoHundredVerticesAtTheMost) {
  const std::vector<Point3> points = long_run(2, 0.001);
  std::vector<Point3> other = points;
  constexpr std::size_t kMoved = 3000;
  other[kMoved].z() += 0.004;
  FairOptions options;
  options.tolerance = kTolerance;
  const auto before = fair_path(points, options);
  const auto after = fair_path(other, options);
  ASSERT_TRUE(before && after);
  double near = 0;
  double far = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double off = (before->curve.point_at(before->vertex_parameters[i]) -
                        after->curve.point_at(after->vertex_parameters[i]))
                           .norm();
    const std::size_t away = i > kMoved ? i - kMoved : kMoved - i;
    double& most = away > kFelt ? far : near;
    most = std::max(most, off);
  }
  EXPECT_GT(near, 1e-4);
  EXPECT_LE(far, 0.01 * kTolerance);
}

}  // namespace
}  // namespace batten::geometry
