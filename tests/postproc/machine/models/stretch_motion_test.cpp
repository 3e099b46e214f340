// The way along a stretch in time against its duration and its limits.
#include "postproc/machine/models/velocity_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace batten::postproc {
namespace {

// 0 to 20 mm/s in .02 s and .2 mm, .6 mm at it, .02 s and .2 mm down again.
TEST(StretchMotion, GoesThroughATrapezoid) {
  VelocityStretch s;
  s.length = 1;
  s.max_velocity = 20;
  s.acceleration = 1000;
  const StretchMotion motion(s, 0, 0, {});
  EXPECT_NEAR(motion.duration(), 0.02 + 0.03 + 0.02, 1e-12);
  EXPECT_EQ(motion.way_at(0), 0);
  EXPECT_NEAR(motion.way_at(0.01), 0.05, 1e-12);
  EXPECT_NEAR(motion.way_at(0.035), 0.5, 1e-12);
  EXPECT_NEAR(motion.way_at(0.06), 0.95, 1e-12);
  EXPECT_EQ(motion.way_at(0.07), 1);
  EXPECT_NEAR(motion.time_below(10), 0.02, 1e-12);
  EXPECT_NEAR(motion.time_below(20), 0.07, 1e-12);
  EXPECT_EQ(motion.time_below(0), 0);
}

TEST(StretchMotion, RestsAfterAStop) {
  VelocityStretch s;
  s.length = 1;
  s.max_velocity = 20;
  s.acceleration = 1000;
  ProfileRules rules;
  rules.stop_time = 0.25;
  const StretchMotion motion(s, 0, 0, rules);
  EXPECT_NEAR(motion.duration(), 0.32, 1e-12);
  EXPECT_EQ(motion.way_at(0.3), 1);
  EXPECT_NEAR(motion.time_below(1e-9), 0.25, 1e-9);
}

TEST(StretchMotion, ChangesItsSpeedEvenlyOverAShortStretch) {
  VelocityStretch s;
  s.length = 0.3;
  s.max_velocity = 100;
  s.acceleration = 10000;
  ProfileRules rules;
  rules.ramp_time = 0.01;
  const StretchMotion motion(s, 40, 60, rules);
  EXPECT_NEAR(motion.duration(), 0.3 / 50, 1e-12);
  // s = 40 t + a t^2 / 2 with a = 20 / .006.
  EXPECT_NEAR(motion.way_at(0.003), 0.12 + 20 / 0.006 * 9e-6 / 2, 1e-12);
}

struct RandomStretch {
  VelocityStretch stretch;
  double v0 = 0;
  double v1 = 0;
};

// With ends that its length allows.
RandomStretch random_stretch(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  RandomStretch r;
  VelocityStretch& s = r.stretch;
  s.length = 0.05 + 20 * unit(random) * unit(random);
  s.acceleration = 500 + 4000 * unit(random);
  s.max_velocity = 10 + 200 * unit(random);
  if (seed % 2 == 0) {
    s.curvature = 0.01 + unit(random);
    s.max_velocity = std::min(s.max_velocity, std::sqrt(0.866 * s.acceleration / s.curvature));
  }
  r.v0 = s.max_velocity * unit(random);
  r.v1 = r.v0;
  // The other end as far away as the way allows, by bisection.
  double low = r.v0;
  double high = s.max_velocity;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (speeding_up_way(s, r.v0, middle) < s.length ? low : high) = middle;
  }
  r.v1 = r.v0 + (low - r.v0) * unit(random);
  if (seed % 3 == 0) std::swap(r.v0, r.v1);
  return r;
}

TEST(StretchMotion, CoversItsWayWithinItsLimits) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomStretch r = random_stretch(seed);
    const StretchMotion motion(r.stretch, r.v0, r.v1, {});
    EXPECT_NEAR(motion.duration(), stretch_time(r.stretch, r.v0, r.v1, {}), 1e-12);
    constexpr int kSteps = 400;
    const double dt = motion.duration() / kSteps;
    double before = 0;
    double speed_before = r.v0;
    for (int i = 1; i <= kSteps; ++i) {
      const double way = motion.way_at(i * dt);
      const double speed = (way - before) / dt;
      EXPECT_GE(speed, -1e-9);
      EXPECT_LE(speed, r.stretch.max_velocity * 1.001);
      if (i > 1) {
        EXPECT_LE(std::abs(speed - speed_before), r.stretch.acceleration * dt * 1.03);
      }
      before = way;
      speed_before = speed;
    }
    EXPECT_NEAR(before, r.stretch.length, 1e-9 * r.stretch.length);
    // The last phase runs into the end: no jump is left over for it.
    EXPECT_NEAR(motion.way_at(motion.duration() * (1 - 1e-6)), r.stretch.length,
                2e-6 * motion.duration() * r.stretch.max_velocity + 1e-4 * r.stretch.length);
    EXPECT_NEAR(motion.time_below(r.stretch.max_velocity * 1.01), motion.duration(), 1e-9);
  }
}

}  // namespace
}  // namespace batten::postproc
