#include "postproc/machine/models/velocity_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "postproc/machine/models/jerk_motion.h"

namespace batten::postproc {
namespace {

// Ten millimetres, a short stretch between two joints of 50 mm/s, ten millimetres.
std::vector<VelocityStretch> short_stretch_between_joints(double length) {
  VelocityStretch wide;
  wide.length = 10;
  wide.max_velocity = 50;
  wide.acceleration = 2000;
  VelocityStretch narrow = wide;
  narrow.length = length;
  narrow.max_velocity = 100;
  return {wide, narrow, wide};
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
  ProfileRules rules;
  rules.ramp_time = 0.01;
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
  ProfileRules rules;
  rules.stop_time = 0.25;
  EXPECT_NEAR(profile_time(chain, rules), profile_time(chain, {}) + 0.5, 1e-12);
}

TEST(ProfileTime, IsZeroForNothing) { EXPECT_EQ(profile_time({}, {}), 0); }

}  // namespace
}  // namespace batten::postproc
