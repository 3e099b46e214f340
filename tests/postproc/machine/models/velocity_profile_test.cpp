// The fastest run along a chain of stretches: its time, the way along a stretch in time, S-curves
// where jerk is limited. Closed forms, the limits, and never faster than without them.
#include "postproc/machine/models/velocity_profile.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "postproc/machine/models/cycle_time.h"
#include "postproc/machine/models/jerk_motion.h"

namespace batten::postproc {
namespace {

VelocityStretch without_jerk(double length, double velocity, double acceleration) {
  return {.length = length, .max_velocity = velocity, .acceleration = acceleration};
}

// Ten millimetres, a short stretch between two joints of 50 mm/s, ten millimetres.
std::vector<VelocityStretch> short_stretch_between_joints(double length) {
  const VelocityStretch wide = without_jerk(10, 50, 2000);
  return {wide, without_jerk(length, 100, 2000), wide};
}

// The two long ones: 50 mm/s after .025 s and .625 mm, the rest evenly.
constexpr double kBothEnds = 2 * (0.025 + (10 - 0.625) / 50);

TEST(ProfileTime, SpeedsUpWithinAStretch) {
  // The peak in the middle of .4 mm: sqrt(50^2 + 2000 * .4) mm/s.
  const double peak = std::sqrt(50 * 50 + 2000 * 0.4);
  EXPECT_NEAR(profile_time(short_stretch_between_joints(0.4), {}),
              kBothEnds + 2 * (peak - 50) / 2000, 1e-12);
}

TEST(ProfileTime, CrossesShortStretchesEvenlyWhereTheControlDoes) {
  const ProfileRules rules{.ramp_time = 0.01};
  EXPECT_NEAR(profile_time(short_stretch_between_joints(0.4), rules), kBothEnds + 0.4 / 50, 1e-12);
  std::vector<VelocityStretch> chain = short_stretch_between_joints(0.4);
  chain[1].runs_on = false;
  EXPECT_NEAR(profile_time(chain, rules), profile_time(chain, {}), 1e-12);
  chain = short_stretch_between_joints(0.6);  // 12 ms at 50 mm/s
  EXPECT_NEAR(profile_time(chain, rules), profile_time(chain, {}), 1e-12);
}

TEST(ProfileTime, CountsTheLossOfEveryStop) {
  std::vector<VelocityStretch> chain = short_stretch_between_joints(0.4);
  chain[0].exit_velocity = 0;
  const ProfileRules rules{.stop_time = 0.25};
  EXPECT_NEAR(profile_time(chain, rules), profile_time(chain, {}) + 0.5, 1e-12);
}

TEST(ProfileTime, IsZeroForNothing) { EXPECT_EQ(profile_time({}, {}), 0); }

// --- the way along a stretch ---------------------------------------------------------------------

// 0 to 20 mm/s in .02 s and .2 mm, .6 mm at it, .02 s and .2 mm down again.
TEST(StretchMotion, GoesThroughATrapezoid) {
  const VelocityStretch s = without_jerk(1, 20, 1000);
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
  const StretchMotion rests(s, 0, 0, {.stop_time = 0.25});
  EXPECT_NEAR(rests.duration(), 0.32, 1e-12);
  EXPECT_EQ(rests.way_at(0.3), 1);
  EXPECT_NEAR(rests.time_below(1e-9), 0.25, 1e-9);
}

TEST(StretchMotion, ChangesItsSpeedEvenlyOverAShortStretch) {
  const VelocityStretch s = without_jerk(0.3, 100, 10000);
  const ProfileRules rules{.ramp_time = 0.01};
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

// --- limits on jerk ------------------------------------------------------------------------------

constexpr double kRampAcceleration = 1000;
constexpr double kJerk = 10000;

VelocityStretch stretch(double length, double velocity) {
  VelocityStretch s = without_jerk(length, velocity, kRampAcceleration);
  s.jerk = kJerk;
  return s;
}

JerkMotion motion_of(const std::vector<VelocityStretch>& chain) {
  return {chain, joint_velocities(chain, {}), {}};
}

// 0 to 150 mm/s: 150 / 1000 + 1000 / 10000 = .25 s and 75 * .25 = 18.75 mm, twice; between them
// (100 - 37.5) / 150.
TEST(JerkMotion, RunsALongLineInSevenPhases) {
  const std::vector<VelocityStretch> chain = {stretch(100, 150)};
  const JerkMotion motion = motion_of(chain);
  EXPECT_NEAR(motion.duration(), 0.5 + 62.5 / 150, 1e-9);
  EXPECT_NEAR(profile_time(chain, {}), motion.duration(), 1e-12);
  // .1 s of jerk: j t^3 / 6, then .05 s at 1000 mm/s^2 from 50 mm/s on.
  EXPECT_NEAR(motion.way_at(0.1), 10000 * 1e-3 / 6, 1e-9);
  EXPECT_NEAR(motion.velocity_at(0.1), 50, 1e-9);
  EXPECT_NEAR(motion.velocity_at(0.15), 100, 1e-9);
  EXPECT_NEAR(motion.way_at(0.25), 18.75, 1e-9);
  EXPECT_NEAR(motion.velocity_at(0.3), 150, 1e-9);
  EXPECT_NEAR(motion.time_at(50), motion.duration() / 2, 1e-9);
  EXPECT_NEAR(motion.time_below(75, 0, motion.duration()), 0.25, 1e-9);
}

// Too short for the acceleration: four phases of jerk, L = 2 j (T/4)^3, T = 4 cbrt(L / 2j).
TEST(JerkMotion, RunsAShortLineInFour) {
  const double length = 0.4;
  EXPECT_NEAR(motion_of({stretch(length, 150)}).duration(), 4 * std::cbrt(length / 2 / kJerk),
              1e-6);
}

// A corner passed at 5 mm/s between two lines: from 150 down and up again, 145 mm/s each:
// .145 + .1 s and 77.5 * .245 mm.
TEST(JerkMotion, SlowsDownForACorner) {
  std::vector<VelocityStretch> chain = {stretch(100, 150), stretch(100, 150)};
  chain[0].exit_velocity = 5;
  const double ramp = 0.245;
  const double one = 0.25 + ramp + (100 - 18.75 - 77.5 * ramp) / 150;
  const JerkMotion motion = motion_of(chain);
  EXPECT_NEAR(motion.duration(), 2 * one, 1e-9);
  EXPECT_NEAR(motion.velocity_at(motion.time_at(100)), 5, 1e-3);
}

// Pieces of one line are one line: the acceleration goes on over their joints.
TEST(JerkMotion, DoesNotFeelTheJointsOfALine) {
  std::vector<VelocityStretch> parts;
  for (int i = 0; i < 200; ++i) parts.push_back(stretch(0.5, 150));
  EXPECT_NEAR(motion_of(parts).duration(), motion_of({stretch(100, 150)}).duration(), 1e-6);
}

// A short stretch that allows more speed is no reason to speed up for its own sake: the way is too
// short for the S-curve up to 150 and down.
TEST(JerkMotion, SpeedsUpNoMoreThanTheWayAllows) {
  const std::vector<VelocityStretch> chain = {stretch(100, 50), stretch(1, 150), stretch(100, 50)};
  const JerkMotion motion = motion_of(chain);
  // Up from 50 to v and down within 1 mm: (50 + v) sqrt((v - 50) / j) * 2 = 1.
  double low = 50;
  double high = 150;
  for (int i = 0; i < 60; ++i) {
    const double v = (low + high) / 2;
    (2 * (50 + v) * std::sqrt((v - 50) / kJerk) < 1 ? low : high) = v;
  }
  EXPECT_NEAR(motion.velocity_at(motion.time_at(100.5)), low, 1e-3);
}

std::vector<VelocityStretch> random_stretches(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<VelocityStretch> chain;
  const int n = 1 + static_cast<int>(unit(random) * 60);
  for (int i = 0; i < n; ++i) {
    VelocityStretch s = stretch(0.02 + 30 * std::pow(unit(random), 3), 5 + 200 * unit(random));
    s.acceleration = 500 + 1500 * unit(random);
    if (unit(random) < 0.3) s.exit_velocity = 60 * unit(random) * (unit(random) < 0.7 ? 1 : 0);
    if (unit(random) < 0.3) {
      s.curvature = 0.02 + unit(random);
      s.max_velocity = std::min(s.max_velocity, std::sqrt(0.866 * s.acceleration / s.curvature));
    }
    chain.push_back(s);
  }
  return chain;
}

TEST(JerkMotion, CoversTheWayWithinItsLimits) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::vector<VelocityStretch> chain = random_stretches(seed);
    const JerkMotion motion = motion_of(chain);
    double length = 0;
    for (const VelocityStretch& s : chain) length += s.length;
    EXPECT_NEAR(motion.way_at(motion.duration()), length, 1e-6 * length);

    std::vector<VelocityStretch> without = chain;
    for (VelocityStretch& s : without) s.jerk = kNoLimit;
    EXPECT_GE(motion.duration(), profile_time(without, {}) * (1 - 1e-9));

    constexpr int kSteps = 2000;
    const double dt = motion.duration() / kSteps;
    double speed = 0;
    double way = 0;
    double acceleration = 0;
    for (int i = 1; i <= kSteps; ++i) {
      const double next = motion.velocity_at(i * dt);
      const double change = (next - speed) / dt;
      EXPECT_LE(std::abs(change), 2000 * 1.001);
      EXPECT_LE(std::abs(change - acceleration), 2 * kJerk * dt + 1e-3);
      EXPECT_GE(motion.way_at(i * dt), way);
      way = motion.way_at(i * dt);
      speed = next;
      acceleration = change;
    }
  }
}

TEST(JerkMotion, NearsTheProfileWithoutALimitAsTheJerkGrows) {
  for (unsigned seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::vector<VelocityStretch> chain = random_stretches(seed);
    double before = 1e9;
    for (const double jerk : {1e3, 1e4, 1e5, 1e6, 1e8}) {
      for (VelocityStretch& s : chain) s.jerk = jerk;
      const double time = profile_time(chain, {});
      EXPECT_LE(time, before * (1 + 1e-6));
      before = time;
    }
    for (VelocityStretch& s : chain) s.jerk = kNoLimit;
    EXPECT_NEAR(before, profile_time(chain, {}), 2e-3 * before);
  }
}

// The built-in high-speed mill has a limit on jerk; 600 mm at 30 m/min.
TEST(JerkMotion, CountsInTheTimeOfAMachine) {
  const Machine& m = *find_machine("high-speed");
  const std::vector<TimedPiece> line = {{geometry::Line{{0, 0, 0}, {600, 0, 0}}, 30000}};
  // 500 mm/s: below a^2 / j = 1000, 2 sqrt(500 / 100000) s, 250 times that in mm.
  const double ramp = 2 * std::sqrt(500.0 / 100000);
  EXPECT_NEAR(cutting_time(line, m, gcode::PathMode::kBlending),
              2 * ramp + (600 - 2 * 250 * ramp) / 500, 1e-9);
}

}  // namespace
}  // namespace batten::postproc
