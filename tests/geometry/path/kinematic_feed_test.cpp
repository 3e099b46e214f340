#include "geometry/path/kinematic_feed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "geometry/path/bspline_curve.h"
#include "tests/support/curve_of.h"

namespace batten::geometry {
namespace {

TEST(FeedEstimate, OnALineIsTheFeedOrTheSpeedOfTheSlowestAxis) {
  const BsplineCurve line(BsplineBasis::clamped(3, {0, 1}),
                          {{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {3, 3, 0}});
  KinematicLimits limits;
  EXPECT_NEAR(feed_estimate(line, limits), 25, 1e-12);
  limits.speed = Vector3(500, 7, 500);
  EXPECT_NEAR(feed_estimate(line, limits), 7 * std::sqrt(2.0), 1e-9);
}

// x(s) from differences of x over length, against each limit alone.
TEST(FeedEstimate, IsWhatDifferencesByLengthSay) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int seed = 0; seed < 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "curve " << seed);
    std::vector<Point3> points;
    for (int i = 0; i < 4; ++i) {
      points.emplace_back(3 * i + 0.7 * normal(random), normal(random), normal(random));
    }
    const BsplineCurve curve(BsplineBasis::clamped(3, {0, 1}), points);
    // Places at equal lengths h: u by Newton steps on the length from 0.
    const double h = 2e-3;
    std::vector<Point3> x = {curve.point_at(0)};
    for (double u = 0;;) {
      double next = u + h / curve.derivative_at(u, 1).norm();
      for (int k = 0; k < 4; ++k) {
        const double speed = curve.derivative_at(next, 1).norm();
        next -= (length_between(curve, u, std::min(next, 1.0)) - h) / speed;
      }
      if (next > 1) break;
      u = next;
      x.push_back(curve.point_at(u));
    }
    Vector3 first = Vector3::Zero();
    Vector3 second = Vector3::Zero();
    Vector3 third = Vector3::Zero();
    for (std::size_t i = 2; i + 2 < x.size(); ++i) {
      first = first.cwiseMax(((x[i + 1] - x[i - 1]) / (2 * h)).cwiseAbs());
      second = second.cwiseMax(((x[i + 1] - 2 * x[i] + x[i - 1]) / (h * h)).cwiseAbs());
      third = third.cwiseMax(
          ((x[i + 2] - 2 * x[i + 1] + 2 * x[i - 1] - x[i - 2]) / (2 * h * h * h)).cwiseAbs());
    }
    const Vector3 none = Vector3::Constant(1e12);
    const Vector3 given(3, 5, 7);
    const double by_speed = given.cwiseQuotient(first).minCoeff();
    const double by_acceleration = std::sqrt(given.cwiseQuotient(second).minCoeff());
    const double by_jerk = std::cbrt(given.cwiseQuotient(third).minCoeff());
    EXPECT_NEAR(feed_estimate(curve, {1e6, given, none, none}) / by_speed, 1, 2e-2);
    EXPECT_NEAR(feed_estimate(curve, {1e6, none, given, none}) / by_acceleration, 1, 2e-2);
    EXPECT_NEAR(feed_estimate(curve, {1e6, none, none, given}) / by_jerk, 1, 2e-2);
  }
}

// Almost a cusp, away from the middle: the peak is a hundredth of the parameter wide.
TEST(FeedEstimate, SeesNarrowPeaks) {
  const BsplineCurve curve(BsplineBasis::clamped(3, {0, 1}),
                           {{0, 0, 0}, {10, 1.01, 0}, {-1.08, 1, 0}, {8, 0.3, 0}});
  KinematicLimits limits;
  limits.feed = 1e6;
  limits.speed = limits.acceleration = Vector3::Constant(1e12);
  double slowest = 0;
  constexpr int kSamples = 200000;
  for (int i = 0; i <= kSamples; ++i) {
    const double t = static_cast<double>(i) / kSamples;
    const Vector3 d1 = curve.derivative_at(t, 1);
    const Vector3 d2 = curve.derivative_at(t, 2);
    const Vector3 d3 = curve.derivative_at(t, 3);
    // x_ss = d2/v^2 - d1 (d1.d2)/v^4, differentiated by t once more and divided by v.
    const double w = d1.squaredNorm();
    const double p = d1.dot(d2);
    const double dp = d2.squaredNorm() + d1.dot(d3);
    const Vector3 by_t =
        d3 / w - 2 * p / (w * w) * d2 - (p * d2 + dp * d1) / (w * w) + 4 * p * p / (w * w * w) * d1;
    slowest = std::max(slowest, (by_t / std::sqrt(w)).cwiseAbs().maxCoeff());
  }
  const double expected = std::cbrt(5000 / slowest);
  EXPECT_NEAR(feed_estimate(curve, limits) / expected, 1, 1e-4);
}

}  // namespace
}  // namespace batten::geometry
