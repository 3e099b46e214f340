// A long run is one fit, and still no place of it knows of what is far away: overlapping windows
// would give the same curve.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include "geometry/fair.h"
#include "geometry/fair_measure.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

constexpr double kTolerance = 0.01;
constexpr std::size_t kOverlap = 200;  // vertices at either end of a window that are not looked at

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

// Windows start where the whole run has one of its first knots (every 64 vertices).
//
// The greatest distance of the vertices' places on the curve of a window from those on the curve of
// the whole, `overlap` vertices and more from the ends of the window.
double apart(const std::vector<Point3>& points, const FairPath& whole, std::size_t first,
             std::size_t count, std::size_t overlap) {
  const std::vector<Point3> window(points.begin() + static_cast<std::ptrdiff_t>(first),
                                   points.begin() + static_cast<std::ptrdiff_t>(first + count));
  FairOptions options;
  options.tolerance = kTolerance;
  const auto part = fair_path(window, options);
  EXPECT_TRUE(part);
  SplineWalk of_whole(whole.curve.basis().knots(), whole.curve.control_points());
  SplineWalk of_part(part->curve.basis().knots(), part->curve.control_points());
  double most = 0;
  for (std::size_t i = overlap; i + overlap < count; ++i) {
    const Point3 there = of_part.point_at(part->vertex_parameters[i]);
    // Across the path: along it, places are found to a Newton step only.
    double u = whole.vertex_parameters[first + i];
    for (int step = 0; step < 3; ++step) u = of_whole.nearer(u, there);
    most = std::max(most, (of_whole.point_at(u) - there).norm());
  }
  return most;
}

TEST(FairWindows, AWindowGivesTheCurveOfTheWholeRun) {
  for (const double noise : {0.0, 0.002}) {
    const std::vector<Point3> points = long_run(1, noise);
    FairOptions options;
    options.tolerance = kTolerance;
    const auto whole = fair_path(points, options);
    ASSERT_TRUE(whole);
    double most = 0;
    for (const std::size_t first : {512U, 1792U, 3200U, 4992U}) {
      most = std::max(most, apart(points, *whole, first, 800, kOverlap));
    }
    RecordProperty(noise > 0 ? "apart_with_noise_nm" : "apart_nm", static_cast<int>(1e6 * most));
    EXPECT_LE(most, 0.1 * kTolerance) << "noise " << noise;
  }
}

// Where a vertex is moved, the curve moves only beside it.
TEST(FairWindows, AVertexIsFeltOverAHundredVerticesAtTheMost) {
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
    double& most = away > kOverlap ? far : near;
    most = std::max(most, off);
  }
  EXPECT_GT(near, 1e-4);
  EXPECT_LE(far, 0.01 * kTolerance);
}

}  // namespace
}  // namespace batten::geometry
