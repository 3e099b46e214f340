#include "postproc/machine/planner/feed_plan_straight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace batten::postproc {
namespace {

constexpr double kNoLimitHere = std::numeric_limits<double>::infinity();

StraightRun from_rest(double length, const LimitsAlong& limits) {
  return straight_run(length, 0, 0, limits);
}

// v(t) = J t^2 / 2 up to half the peak, so four phases of (L / 2J)^(1/3).
TEST(StraightMove, OfShortLengthIsFourPhasesOfJerk) {
  const LimitsAlong limits{1000, 1000, 1000};
  const StraightRun run = from_rest(0.016, limits);
  EXPECT_NEAR(run.time, 4 * std::cbrt(0.016 / 2000), 1e-12);
  EXPECT_NEAR(run.state_at(0.02).acceleration, 20, 1e-9);
}

// A 100, J 1000, no cruise: v^2 / 100 + v / 10 = 30 gives v = 50, ramps of .5 + .1 s.
TEST(StraightMove, HoldsTheAccelerationLimit) {
  const LimitsAlong limits{1000, 100, 1000};
  const StraightRun run = from_rest(30, limits);
  EXPECT_NEAR(run.peak, 50, 1e-11);
  EXPECT_NEAR(run.time, 1.2, 1e-12);
  for (const double time : {0.1, 0.3, 0.5}) {
    EXPECT_NEAR(run.state_at(time).acceleration, 100, 1e-9);
  }
}

TEST(StraightMove, WithoutJerkLimitIsATrapezoid) {
  const LimitsAlong limits{50, 100, kNoLimitHere};  // .5 s and 12.5 mm to ramp up
  EXPECT_NEAR(from_rest(100, limits).time, 0.5 + 0.5 + 75.0 / 50, 1e-12);
  EXPECT_NEAR(from_rest(1, limits).time, 0.2, 1e-12);
}

TEST(StraightMove, OfNoLengthTakesNoTime) { EXPECT_EQ(from_rest(0, {50, 100, 1000}).time, 0); }

// --- between two speeds --------------------------------------------------------------------------

// From 10 to 20 mm/s with J 1000 takes 2 sqrt(10 / 1000) = .2 s and 3 mm; back the same.
TEST(StraightRun, RampsUpAndDown) {
  const LimitsAlong limits{1000, 1000, 1000};
  const StraightRun run = straight_run(6, 10, 10, limits);
  EXPECT_NEAR(run.peak, 20, 1e-9);
  EXPECT_NEAR(run.time, 0.4, 1e-12);
  // 5 mm further at 20 mm/s where that is the limit.
  EXPECT_NEAR(straight_run(11, 10, 10, {20, 1000, 1000}).time, 0.65, 1e-12);
  // From 0 to 10 mm/s takes .2 s and 1 mm; a peak 1e-14 higher would already take 1e-8 s.
  EXPECT_NEAR(straight_run(1, 0, 10, limits).time, 0.2, 1e-7);
}

// A 100, J 1000, from 10 to 30 and to 0: .2 + .1 s over 6 mm, and .3 + .1 s over 6 mm.
TEST(StraightRun, HoldsTheAccelerationLimit) {
  const StraightRun run = straight_run(12, 10, 0, {1000, 100, 1000});
  EXPECT_NEAR(run.peak, 30, 1e-9);
  EXPECT_NEAR(run.time, 0.7, 1e-12);
}

TEST(StraightRun, OfTooShortAWayTakesTheMeanSpeed) {
  EXPECT_NEAR(straight_run(1, 0, 50, {100, 1000, 1000}).time, 1 / 25.0, 1e-12);
}

// The state by many small steps of constant jerk.
TEST(StraightRun, GoesFromSpeedToSpeedWithinItsLimits) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> exponent(-2, 2);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(testing::Message() << "run " << i);
    const double length = std::pow(10, exponent(random));
    const LimitsAlong limits{std::pow(10, exponent(random)), std::pow(10, 1 + exponent(random)),
                             std::pow(10, 2 + exponent(random))};
    const double peak = from_rest(length, limits).peak;
    const double from = i % 3 == 0 ? 0 : 0.3 * unit(random) * peak;
    const double to = i % 6 == 0 ? 0 : 0.3 * unit(random) * peak;
    const StraightRun run = straight_run(length, from, to, limits);
    const StraightRun back = straight_run(length, run.to, run.from, limits);
    EXPECT_NEAR(back.time / run.time, 1, 1e-9);
    EXPECT_LE(run.time, from_rest(length, limits).time * (1 + 1e-9));
    constexpr int kSteps = 1000;
    const double h = run.time / kSteps;
    for (int k = 0; k < kSteps; ++k) {
      const StraightState a = run.state_at(k * h);
      const StraightState b = run.state_at((k + 1) * h);
      EXPECT_LE(b.speed, limits.speed * (1 + 1e-9));
      EXPECT_LE(std::abs(b.acceleration), limits.acceleration * (1 + 1e-9));
      EXPECT_LE(std::abs(b.acceleration - a.acceleration), limits.jerk * h * (1 + 1e-6));
      EXPECT_NEAR(b.distance - a.distance, 0.5 * (a.speed + b.speed) * h,
                  limits.jerk * h * h * h + 1e-9 * length);
    }
    EXPECT_NEAR(run.state_at(0).speed, run.from, 1e-9 * peak);
    EXPECT_NEAR(run.state_at(run.time).speed, run.to, 1e-6 * peak);
    EXPECT_NEAR(run.state_at(run.time).distance / length, 1, 1e-9);
  }
}

// No faster move exists: one limit binds at every moment (bang-bang), so each third of a percent
// off a limit costs time.
TEST(StraightMove, IsSlowerWithAnyLowerLimitThatItMeets) {
  const LimitsAlong limits{50, 300, 2000};
  const double time = from_rest(40, limits).time;
  EXPECT_GT(from_rest(40, {49.9, 300, 2000}).time, time);
  EXPECT_GT(from_rest(40, {50, 299, 2000}).time, time);
  EXPECT_GT(from_rest(40, {50, 300, 1990}).time, time);
}

}  // namespace
}  // namespace batten::postproc
