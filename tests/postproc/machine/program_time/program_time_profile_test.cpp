// The samples of a program's motion against its time, its path and the limits of the machine.
#include "postproc/machine/program_time/program_time_profile.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "postproc/machine/program_time/program_time.h"
#include "tests/support/interpreted.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

Machine machine_of(ControllerModel model) {
  Machine m;
  m.name = "test";
  m.model = model;
  set_max_velocity(m, 200);
  set_rapid_velocity(m, 300);
  set_max_acceleration(m, 1000);
  m.block_period = 0.001;
  m.look_ahead = 1000;
  m.blend_tolerance = 0.01;
  return m;
}

struct SampledProgram {
  std::vector<ProfileSample> samples;
  double seconds = 0;
};

SampledProgram sampled(const std::string& text, const Machine& m, double period = 0.001) {
  const tests::Interpreted program(text);
  StepOptions options;
  options.start = Point3::Zero();
  const ProgramSteps steps = read_steps(program.program, program.read, options);
  SampledProgram result;
  EXPECT_TRUE(sample_program(program.program, steps, m, period, [&](const ProfileSample& s) {
    result.samples.push_back(s);
    return true;
  }));
  result.seconds = time_steps(program.program, steps, m).seconds.sum();
  return result;
}

constexpr ControllerModel kModels[] = {ControllerModel::kLookAhead, ControllerModel::kLinuxcnc,
                                       ControllerModel::kGrbl};

class ProfileOf : public testing::TestWithParam<ControllerModel> {};
INSTANTIATE_TEST_SUITE_P(ProgramProfile, ProfileOf, testing::ValuesIn(kModels),
                         [](const auto& test) {
                           return test.param == ControllerModel::kLookAhead  ? "LookAhead"
                                  : test.param == ControllerModel::kLinuxcnc ? "Linuxcnc"
                                                                             : "Grbl";
                         });

// 0 to 100 mm/s in .1 s, .4 s at it, .1 s down; the rapid behind it makes it come to rest.
TEST_P(ProfileOf, ALineIsATrapezoid) {
  const SampledProgram p = sampled("G21 G90\nG1 X50 F6000\nG0 Z1\nM2\n", machine_of(GetParam()));
  ASSERT_GE(p.samples.size(), 601u);
  const auto& s = p.samples;
  EXPECT_NEAR(s[50].place.x(), 1000 * 0.05 * 0.05 / 2, 1e-6);
  EXPECT_NEAR(s[50].acceleration.x(), 1000, 1);
  EXPECT_NEAR(s[50].jerk.x(), 0, 1);
  EXPECT_NEAR(s[300].place.x(), 5 + 20, 1e-6);
  EXPECT_NEAR(s[300].feed, 6000, 1e-3);
  EXPECT_NEAR(s[300].acceleration.x(), 0, 1e-3);
  EXPECT_EQ(s[300].line, 2u);
}

TEST_P(ProfileOf, LastsAsLongAsTheProgram) {
  const Machine m = machine_of(GetParam());
  const std::string text =
      "G21 G90\nG0 X10 Y10 Z5\nM3 S100\nG1 Z-1 F300\nX30 F2000\nY20\nG3 X20 Y30 I-10\nG1 X0 Y0\n"
      "G4 X0.1\nG0 Z50\nM2\n";
  const SampledProgram p = sampled(text, m);
  EXPECT_GE(p.samples.back().time, p.seconds - 1e-9);
  EXPECT_LT(p.samples.back().time, p.seconds + 0.001);
  EXPECT_LT((p.samples.back().place - Point3(0, 0, 50)).norm(), 1e-9);
  for (std::size_t i = 1; i < p.samples.size(); ++i) {
    EXPECT_NEAR(p.samples[i].time - p.samples[i - 1].time, 0.001, 1e-9);
    EXPECT_GE(p.samples[i].line, p.samples[i - 1].line);
  }
}

// Between the corners no axis has more than its acceleration; in a corner of the generic model
// it may have a step of speed of what one period allows, which a period's difference shows as
// the acceleration once more. grbl's corners are steps by design.
TEST_P(ProfileOf, KeepsTheLimitsOfTheAxes) {
  const Machine m = machine_of(GetParam());
  if (m.model == ControllerModel::kGrbl) return;
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    std::string text = "G21 G90\nG1 F3000\n";
    for (int i = 0; i < 40; ++i) {
      text += fmt::format("X{:.3f} Y{:.3f}\n", 3 * i + unit(random), 6 * unit(random));
    }
    const SampledProgram p = sampled(text + "G0 Z1\nM2\n", m);
    double speed = 0;
    double acceleration = 0;
    for (const ProfileSample& s : p.samples) {
      speed = std::max(speed, s.feed);
      acceleration = std::max(acceleration, s.acceleration.cwiseAbs().maxCoeff());
    }
    // The bends of LinuxCNC's corners stand for its blend arcs, evenly to some per cent.
    EXPECT_LE(speed, 3000 * (m.model == ControllerModel::kLinuxcnc ? 1.03 : 1.001));
    EXPECT_LE(acceleration, 2.05 * m.max_acceleration());
    EXPECT_GE(acceleration, 0.99 * m.max_acceleration());
  }
}

// An arc at 50 mm/s on a radius of 10 mm: v^2 / r = 250 mm/s^2 towards the centre.
TEST_P(ProfileOf, ABendPullsTowardsItsCentre) {
  const SampledProgram p =
      sampled("G21 G90\nG0 X0 Y0\nG3 X0 Y0 I-10 J0 F3000\nG0 Z1\nM2\n", machine_of(GetParam()));
  const ProfileSample& s = p.samples[p.samples.size() / 2];
  EXPECT_NEAR(s.feed, 3000, 15);
  const Point3 from_centre = s.place - Point3(-10, 0, 0);
  EXPECT_NEAR(from_centre.norm(), 10, 0.01);
  if (GetParam() == ControllerModel::kGrbl) return;  // chords: none or a step
  EXPECT_NEAR(s.acceleration.dot(from_centre) / 10, -250, 3);
}

// The corner of a square under G64 P0.01 on LinuxCNC: the samples cut it by no more than P.
TEST(ProfileOnLinuxcnc, RunsThroughTheBlendArcs) {
  const SampledProgram p = sampled("G21 G90\nG64 P0.05\nG1 X20 F3000\nY20\nG0 Z1\nM2\n",
                                   machine_of(ControllerModel::kLinuxcnc));
  double nearest = 1e9;
  for (const ProfileSample& s : p.samples) {
    nearest = std::min(nearest, (s.place - Point3(20, 0, 0)).norm());
  }
  EXPECT_GT(nearest, 0.005);
  EXPECT_LT(nearest, 0.08) << "at most P and half a period's way";
}

TEST(Profile, StopsWhenItIsTold) {
  const tests::Interpreted program("G21 G90\nG1 X50 F6000\nM2\n");
  StepOptions options;
  options.start = Point3::Zero();
  const ProgramSteps steps = read_steps(program.program, program.read, options);
  int samples = 0;
  EXPECT_FALSE(sample_program(program.program, steps, machine_of(ControllerModel::kLookAhead),
                              0.001, [&](const ProfileSample&) { return ++samples < 10; }));
  EXPECT_EQ(samples, 10);
}

}  // namespace
}  // namespace batten::postproc
