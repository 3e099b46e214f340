#include "geometry/fitting/fair/corner_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace batten::geometry {
namespace {

constexpr double kDegreeOfTurn = std::numbers::pi / 180;

struct Chain {
  std::vector<Point3> points;
  std::vector<double> parameters;
};

// Two lines of so many edges of `step` that meet at an angle, in a plane that slants in space.
Chain broken_line(std::size_t before, std::size_t behind, double step, double angle) {
  const Vector3 in = Vector3(2, 1, 2) / 3;
  const Vector3 left = Vector3(-2, 2, 1) / 3;
  Chain chain;
  for (std::size_t i = 0; i <= before + behind; ++i) {
    const double s = step * (static_cast<double>(i) - static_cast<double>(before));
    const Vector3 out = std::cos(angle) * in + std::sin(angle) * left;
    chain.points.emplace_back(s * (s < 0 ? in : out));
    chain.parameters.push_back(s);
  }
  return chain;
}

TEST(Kink, IsTheAngleOfTwoLinesWhereverTheirEndsAre) {
  for (const double degrees : {0.0, 1.0, 20.0, 90.0, 150.0}) {
    for (const std::size_t before : {2, 3, 4, 6, 9}) {
      const Chain chain = broken_line(before, 5, 0.4, degrees * kDegreeOfTurn);
      const auto kink = kink_at(chain.points, chain.parameters, before, 0.01);
      ASSERT_TRUE(kink);
      EXPECT_NEAR(kink->angle, degrees * kDegreeOfTurn, 1e-7) << before;
    }
  }
}

// A cubic, and with six vertices on either side one of the fourth degree, has no kink.
TEST(Kink, IsNoneInABendThatChanges) {
  for (const std::size_t beside : {4, 6}) {
    Chain chain;
    for (std::size_t i = 0; i <= 2 * beside; ++i) {
      const double x = 0.5 * (static_cast<double>(i) - static_cast<double>(beside));
      const double fourth = beside == 6 ? 0.01 * std::pow(x, 4) : 0;
      chain.points.emplace_back(x, 0.3 * x * x - 0.05 * std::pow(x, 3) + fourth, 0);
      chain.parameters.push_back(x);
    }
    const auto kink = kink_at(chain.points, chain.parameters, beside, 0.01);
    ASSERT_TRUE(kink);
    EXPECT_LE(kink->angle, 1e-7);
  }
}

// Noise across a straight line, in one direction: the angle is the amount of a normal variable,
// whose mean square is the square of its standard deviation.
TEST(Kink, OfNoiseAloneIsAsGreatAsItSays) {
  for (const std::size_t beside : {3, 4, 5, 6}) {
    const Chain line = broken_line(beside, beside, 0.5, 0);
    std::mt19937 random(7);
    std::normal_distribution<double> off(0, 0.01);
    double squares = 0;
    double said = 0;
    constexpr int kTimes = 4000;
    for (int k = 0; k < kTimes; ++k) {
      Chain noisy = line;
      for (Point3& p : noisy.points) p += off(random) * Vector3(-2, 2, 1) / 3;
      const auto kink = kink_at(noisy.points, noisy.parameters, beside, 0.01);
      ASSERT_TRUE(kink);
      squares += kink->angle * kink->angle;
      said = kink->deviation;
    }
    // The mean of 4000 squares is known to sqrt(2 / 4000) = 2.2 % (one standard deviation).
    EXPECT_NEAR(std::sqrt(squares / kTimes) / said, 1, 0.05) << beside;
  }
}

TEST(Kink, IsNotKnownAtAnEndNorAmongTooFewVertices) {
  const Chain chain = broken_line(2, 9, 1, 1);
  EXPECT_FALSE(kink_at(chain.points, chain.parameters, 0, 0.01));
  EXPECT_FALSE(kink_at(chain.points, chain.parameters, 11, 0.01));
  EXPECT_TRUE(kink_at(chain.points, chain.parameters, 1, 0.01));
  const Chain few = broken_line(2, 2, 1, 1);
  EXPECT_FALSE(kink_at(few.points, few.parameters, 2, 0.01));
}

}  // namespace
}  // namespace batten::geometry
