// What the machine needs is given where it needs it, and nowhere else.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/fitting/fair/fair.h"
#include "geometry/fitting/fair/fair_measure.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

constexpr double kNeedTolerance = 0.01;
constexpr double kStep = 0.25;      // mm along x from vertex to vertex
constexpr double kRippleAt = 100;   // mm, its middle
constexpr double kRippleWay = 4.5;  // mm to either side: three waves
constexpr double kWave = 3;         // mm

// A gentle bend of radius 200 mm, 200 mm long, vertices 0.0001 mm off it, with a ripple of
// 0.006 mm in its middle that comes and goes gently.
std::vector<Point3> path_with_a_ripple(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-1e-4, 1e-4);
  std::vector<Point3> points;
  for (int i = 0; i <= 800; ++i) {
    const double x = kStep * i;
    const double beside = x - kRippleAt;
    double y = x * x / 400 + off(random);
    if (std::abs(beside) < kRippleWay) {
      const double window = std::pow(std::cos(std::numbers::pi / 2 * beside / kRippleWay), 2);
      y += 0.006 * window * std::cos(2 * std::numbers::pi / kWave * beside);
    }
    points.push_back(printed(Point3(x, y, 0), 4));
  }
  return points;
}

FairOptions options_at(double feed) {
  FairOptions options;
  options.tolerance = kNeedTolerance;
  options.rounding = 5e-5;
  options.feed = feed;
  options.acceleration = 1e9;
  return options;
}

// The slowest speed (mm/s) that the limits allow on a curve between two places of x.
double slowest(const SmoothCurve& path, const TravelLimits& limits, double from, double to) {
  const std::vector<double>& knots = path.curve.basis().knots();
  SplineWalk walk(knots, path.curve.control_points());
  double least = limits.speed;
  constexpr int kPlaces = 20000;
  for (int i = 0; i <= kPlaces; ++i) {
    const double u = std::lerp(path.curve.first(), path.curve.last(), 1.0 * i / kPlaces);
    const double x = walk.point_at(u).x();
    if (x > from && x < to) least = std::min(least, speed_at(walk, u, limits));
  }
  return least;
}

// The greatest distance (mm) between two curves, beyond `away` mm from the ripple.
double moved_beyond(const SmoothCurve& a, const SmoothCurve& b, double away) {
  double most = 0;
  for (std::size_t i = 0; i < a.vertex_parameters.size(); ++i) {
    const Point3 there = a.curve.point_at(a.vertex_parameters[i]);
    if (std::abs(there.x() - kRippleAt) < away) continue;
    most = std::max(most, (there - b.curve.point_at(b.vertex_parameters[i])).norm());
  }
  return most;
}

// The ripple's curvature is 0.006 (2 pi / 3)^2 = 0.026/mm, the bend's 0.005/mm and less; its third
// derivative 0.006 (2 pi / 3)^3 = 0.055/mm^2, and the bend has next to none. So at 100 mm/s the one
// asks for 260 mm/s^2 and 55000 mm/s^3, the other for 50 mm/s^2.
TEST(FairNeed, MovesARippleThatIsTooTightAndNothingElse) {
  for (const bool by_jerk : {false, true}) {
    FairOptions options = options_at(6000);
    (by_jerk ? options.jerk : options.acceleration) = by_jerk ? 5000 : 60;
    const TravelLimits limits{options.feed / 60, options.acceleration, options.jerk};
    for (unsigned seed = 1; seed <= 5; ++seed) {
      SCOPED_TRACE(testing::Message() << (by_jerk ? "jerk" : "acceleration") << ", seed " << seed);
      const std::vector<Point3> points = path_with_a_ripple(seed);
      const auto needy = fair_path(points, options);
      FairOptions patient = options;
      patient.feed = 60;
      const auto true_to_it = fair_path(points, patient);
      ASSERT_TRUE(needy && true_to_it);
      EXPECT_GT(needy->rounds, 0);
      EXPECT_EQ(true_to_it->rounds, 0);
      EXPECT_LE(needy->deviation, kNeedTolerance);
      EXPECT_GT(slowest(*needy, limits, kRippleAt - 10, kRippleAt + 10),
                1.2 * slowest(*true_to_it, limits, kRippleAt - 10, kRippleAt + 10));
      // Beyond it the fit settles anew, within what its vertices scatter.
      EXPECT_LE(moved_beyond(*needy, *true_to_it, kRippleWay + 20 * kStep), 0.03 * kNeedTolerance);
      EXPECT_GT(moved_beyond(*needy, *true_to_it, 0), 0.3 * kNeedTolerance);
    }
  }
}

// With a machine that can hold the feed, nothing is spent on it.
TEST(FairNeed, IsNoneWhereTheMachineHoldsTheFeed) {
  FairOptions options = options_at(6000);
  options.acceleration = 1000;
  options.jerk = 1e6;
  const std::vector<Point3> points = path_with_a_ripple(1);
  const auto path = fair_path(points, options);
  options.accurate = false;
  options.feed = 60;
  const auto slow = fair_path(points, options);
  ASSERT_TRUE(path && slow);
  EXPECT_EQ(path->rounds, 0);
  EXPECT_EQ(moved_beyond(*path, *slow, 0), 0);
}

// A helix of radius r and rise h per radian has the curvature r / (r^2 + h^2), and its third
// derivative by length is as long as r / (r^2 + h^2)^1.5. Here the spline is that of a fine fit.
TEST(SpeedOnACurve, OfAHelixIsThatOfItsClosedForm) {
  constexpr double kRadius = 5;
  constexpr double kPitch = 6;
  const std::vector<Point3> points = helix_path(kRadius, kPitch, 2, 400);
  FairOptions options = options_at(60);
  options.rounding = 1e-9;
  options.accurate = true;
  const auto path = fair_path(points, options);
  ASSERT_TRUE(path);
  SplineWalk walk(path->curve.basis().knots(), path->curve.control_points());
  const double rise = kPitch / (2 * std::numbers::pi);
  const double squares = kRadius * kRadius + rise * rise;
  const double third = kRadius / std::pow(squares, 1.5);
  for (const double part : {0.3, 0.5, 0.6}) {
    const double u = std::lerp(path->curve.first(), path->curve.last(), part);
    EXPECT_NEAR(walk.third_by_length_at(u), third, 0.05 * third);
    EXPECT_NEAR(speed_at(walk, u, {1e9, 1e9, 8 * third}), 2, 0.04);
    EXPECT_NEAR(speed_at(walk, u, {1e9, 9 * kRadius / squares, 1e99}), 3, 0.01);
    EXPECT_EQ(speed_at(walk, u, {1.5, 1e9, 1e99}), 1.5);
  }
}

}  // namespace
}  // namespace batten::geometry
