// A curve on one side of its path where noise fills the band and where there are corners.
#include "geometry/fitting/one_sided/one_sided_fair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/path/path.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

constexpr double kTolerance = 0.05;
constexpr double kWrongSide = 0.1;  // part of the tolerance that the proof allows there

OneSidedOptions options_on(Side side) {
  OneSidedOptions options;
  options.fair.tolerance = kTolerance;
  options.side = side;
  options.margin = 0.004;
  return options;
}

// A wavy line of 60 mm with a corner of `corner` degrees every 15 mm, to the left and the right in
// turn (none for 0), its vertices about 0.5 mm apart and up to `noise` mm beside it.
std::vector<Point3> noisy_path(unsigned seed, double noise, double corner) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> off(-noise, noise);
  std::vector<Point3> points = {Point3::Zero()};
  double direction = 0;
  Point3 place = Point3::Zero();
  for (int i = 1; i <= 120; ++i) {
    place += 0.5 * Point3(std::cos(direction), std::sin(direction), 0.02);
    const Vector3 left(-std::sin(direction), std::cos(direction), 0);
    const bool turns = corner > 0 && i % 30 == 0;
    points.push_back(i == 120 || turns ? place : Point3(place + off(random) * left));
    direction += 0.02 * std::sin(0.1 * i);
    if (turns) direction += (i % 60 == 0 ? -1 : 1) * corner * 3.14159265358979 / 180;
  }
  return points;
}

// What the verifier asks for: half of the tolerance about the path that is moved by as much.
Verdict verdict_of(const std::vector<Point3>& points, const BsplineCurve& curve, Side side) {
  const auto beside = parallel_path(path_through(points), side, kTolerance / 2);
  EXPECT_TRUE(beside);
  const double tolerance = kTolerance / 2 + kWrongSide * kTolerance;
  return compare_paths(*beside, beziers_of(curve), tolerance).verdict;
}

void expect_curves_on_both_sides(double noise, double corner) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const std::vector<Point3> points = noisy_path(seed, noise, corner);
    for (const Side side : {Side::kLeft, Side::kRight}) {
      SCOPED_TRACE(testing::Message()
                   << "seed " << seed << ", noise " << noise << ", corners of " << corner << ", "
                   << (side == Side::kLeft ? "left" : "right"));
      const auto path = one_sided_fair_path(points, options_on(side));
      ASSERT_TRUE(path);
      EXPECT_LE(path->deviation, kTolerance);
      EXPECT_LT((path->curve.point_at(path->curve.first()) - points.front()).norm(), 1e-12);
      EXPECT_LT((path->curve.point_at(path->curve.last()) - points.back()).norm(), 1e-12);
      EXPECT_EQ(verdict_of(points, path->curve, side), Verdict::kProved);
    }
  }
}

TEST(OneSidedFair, FindsACurveWhateverTheNoise) {
  for (const double noise : {0.2, 0.5, 0.8, 1.2}) {
    expect_curves_on_both_sides(noise * kTolerance, 0);
  }
}

TEST(OneSidedFair, FindsACurveRoundCornersToEitherSide) {
  for (const double corner : {20, 45, 70, 90}) expect_curves_on_both_sides(0.0005, corner);
}

TEST(OneSidedFair, FindsACurveRoundCornersBetweenNoisyLegs) {
  for (const double corner : {30, 60, 90}) expect_curves_on_both_sides(0.5 * kTolerance, corner);
}

}  // namespace
}  // namespace batten::geometry
