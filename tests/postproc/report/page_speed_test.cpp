// Speeds along the cutting moves of a program, as the report page draws them.
#include "postproc/report/page_speed.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/support/interpreted.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

constexpr double kAcceleration = 100;  // mm/s^2

Machine steady_machine() {
  Machine m;
  m.name = "test";
  set_max_velocity(m, 400);
  set_max_acceleration(m, kAcceleration);
  set_rapid_velocity(m, 400);
  m.look_ahead = 1000;
  return m;
}

double speed_at(const std::string& program, std::size_t line, double share, const Machine& m) {
  const tests::Interpreted text(program);
  const ReadProgram read{&text.program, &text.read};
  const ProgramSpeeds speeds(read, list_events(read), m);
  return speeds.at(static_cast<std::uint32_t>(text.line(line).motion), share);
}

constexpr const char* kLine = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F6000\n";

// From rest at 100 mm/s2: sqrt(2 a s) after s, 100 mm/s = 6000 mm/min in the middle.
TEST(ProgramSpeeds, AreThoseOfATrapezoid) {
  const Machine m = steady_machine();
  const double after_a_mm = 60 * std::sqrt(2 * kAcceleration);
  EXPECT_NEAR(speed_at(kLine, 3, 0, m), 0, 1e-9);
  EXPECT_NEAR(speed_at(kLine, 3, 0.01, m), after_a_mm, 1e-6);
  EXPECT_NEAR(speed_at(kLine, 3, 0.5, m), 6000, 1e-6);
  EXPECT_NEAR(speed_at(kLine, 3, 0.99, m), after_a_mm, 1e-6);
  EXPECT_NEAR(speed_at(kLine, 3, 1, m), 0, 1e-9);
}

TEST(ProgramSpeeds, AreNothingOnRapids) {
  EXPECT_EQ(speed_at("G21 G90\nG0 X0 Y0 Z0\nG0 X100\nG1 X0 F600\n", 3, 0.5, steady_machine()), 0);
}

// A sharp corner of the generic control: no axis changes its speed by more than a * period.
TEST(ProgramSpeeds, FallAtCorners) {
  const std::string corner = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F3000\nY100\n";
  const Machine m = steady_machine();
  EXPECT_NEAR(speed_at(corner, 3, 1, m), 60 * kAcceleration * m.servo_period, 1e-6);
  EXPECT_NEAR(speed_at(corner, 4, 0, m), 60 * kAcceleration * m.servo_period, 1e-6);
  EXPECT_NEAR(speed_at(corner, 4, 0.5, m), 3000, 1e-6);
}

// With a limit on jerk: after 0.2 s at 500 mm/s3 it has 100 mm/s2, 10 mm/s and 2/3 mm behind it;
// the rest of the first mm takes 0.0292 s at that acceleration.
TEST(ProgramSpeeds, KeepALimitOnJerk) {
  Machine m = steady_machine();
  set_max_jerk(m, 500);
  const std::string line = "G21 G90\nG0 X0 Y0 Z0\nG1 X100 F3000\n";
  EXPECT_NEAR(speed_at(line, 3, 0.01, m), 60 * (10 + 0.0292 * kAcceleration), 4);
  EXPECT_NEAR(speed_at(line, 3, 0.5, m), 3000, 1e-3);
}

}  // namespace
}  // namespace batten::postproc
