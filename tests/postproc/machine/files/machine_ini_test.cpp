#include "postproc/machine/files/machine_ini.h"

#include <gtest/gtest.h>

#include "postproc/machine/machine_fields.h"
#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

struct Read {
  std::shared_ptr<const Machine> machine;
  std::string problems;  // one a line, without the folder
};

Read read(const ScratchFolder& folder, const std::string& file) {
  std::vector<std::string> problems;
  Read result{read_machine_ini(file, problems), {}};
  for (const std::string& problem : problems) {
    result.problems += folder.without_folder(problem) + "\n";
  }
  return result;
}

Read read_text(std::string_view text) {
  const ScratchFolder folder;
  return read(folder, folder.put("my.ini", text));
}

constexpr const char* kMillimetres =
    "# a comment\n"
    "[EMC]\n"
    "MACHINE = router\n"
    "[EMCMOT]\n"
    "SERVO_PERIOD = 500000\n"
    "[TRAJ]\n"
    "COORDINATES = X Y Z\n"
    "LINEAR_UNITS = mm\n"
    "ANGULAR_UNITS = degree\n"
    "MAX_LINEAR_VELOCITY = 150\n"
    "[AXIS_X]\n"
    "MAX_VELOCITY = 120\n"
    "MAX_ACCELERATION = 900\n"
    "[AXIS_Y]\n"
    "  MAX_VELOCITY=110   \n"
    "MAX_ACCELERATION = 800 # with a remark\n"
    "[AXIS_Z]\n"
    "MAX_VELOCITY = 60\n"
    "; MAX_VELOCITY = 1\n"
    "MAX_ACCELERATION = 400\r\n";

// The same machine in inches.
constexpr const char* kInches =
    "[EMCMOT]\n"
    "SERVO_PERIOD = 500000\n"
    "[TRAJ]\n"
    "COORDINATES = XYZ\n"
    "LINEAR_UNITS = inch\n"
    "MAX_LINEAR_VELOCITY = 5.905511811023622\n"
    "[AXIS_X]\n"
    "MAX_VELOCITY = 4.724409448818898\n"
    "MAX_ACCELERATION = 35.43307086614173\n"
    "[AXIS_Y]\n"
    "MAX_VELOCITY = 4.330708661417323\n"
    "MAX_ACCELERATION = 31.49606299212598\n"
    "[AXIS_Z]\n"
    "MAX_VELOCITY = 2.362204724409449\n"
    "MAX_ACCELERATION = 15.74803149606299\n";

void expect_the_machine_of_the_ini(const Machine& m) {
  EXPECT_EQ(m.model, ControllerModel::kLinuxcnc);
  EXPECT_EQ(m.name, "my");
  EXPECT_NEAR(m.axis(Axis::kX).velocity, 120, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kY).velocity, 110, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kZ).velocity, 60, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kZ).rapid_velocity, 60, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kX).acceleration, 900, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kY).acceleration, 800, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kZ).acceleration, 400, 1e-9);
  EXPECT_NEAR(m.path_feed, 150, 1e-9);
  EXPECT_DOUBLE_EQ(m.servo_period, 0.0005);
  EXPECT_DOUBLE_EQ(m.block_period, 0.0005);
}

TEST(MachineIni, GivesLimitsInMillimetres) {
  const Read result = read_text(kMillimetres);
  ASSERT_NE(result.machine, nullptr) << result.problems;
  expect_the_machine_of_the_ini(*result.machine);
}

TEST(MachineIni, GivesLimitsInInches) {
  const Read result = read_text(kInches);
  ASSERT_NE(result.machine, nullptr) << result.problems;
  expect_the_machine_of_the_ini(*result.machine);
}

struct UnitCase {
  const char* text;
  double mm;
};

class IniUnits : public testing::TestWithParam<UnitCase> {};

TEST_P(IniUnits, AreThoseThatLinuxcncKnows) {
  const Read result =
      read_text(std::string("[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = ") + GetParam().text +
                "\n[AXIS_X]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 3\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_NEAR(result.machine->axis(Axis::kX).velocity, 2 * GetParam().mm, 1e-9);
  EXPECT_NEAR(result.machine->axis(Axis::kX).acceleration, 3 * GetParam().mm, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(MachineIni, IniUnits,
                         testing::Values(UnitCase{"mm", 1}, UnitCase{"metric", 1},
                                         UnitCase{"in", 25.4}, UnitCase{"inch", 25.4},
                                         UnitCase{"imperial", 25.4}, UnitCase{"1.0", 1},
                                         UnitCase{"0.03937007874015748", 25.4}));

TEST(MachineIni, BlendsWithoutATolerance) {
  const Read result = read_text(kMillimetres);
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->path_mode, gcode::PathMode::kBlending);
  EXPECT_EQ(result.machine->blend_tolerance, 0);
  EXPECT_EQ(result.machine->naive_cam_tolerance, 0);
}

struct StartupCase {
  const char* units;  // of the machine
  const char* code;
  gcode::PathMode mode;
  double p;  // mm
  double q;
};

class StartupCodes : public testing::TestWithParam<StartupCase> {};

TEST_P(StartupCodes, SetTheBlending) {
  const StartupCase& c = GetParam();
  const Read result = read_text(
      std::string("[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = ") + c.units +
      "\n[AXIS_X]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 3\n[RS274NGC]\nRS274NGC_STARTUP_CODE = " +
      c.code + "\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->path_mode, c.mode);
  EXPECT_NEAR(result.machine->blend_tolerance, c.p, 1e-12);
  EXPECT_NEAR(result.machine->naive_cam_tolerance, c.q, 1e-12);
}

using gcode::PathMode;
INSTANTIATE_TEST_SUITE_P(
    MachineIni, StartupCodes,
    testing::Values(StartupCase{"mm", "G17 G21 G40 G49 G64 P0.02 Q0.05", PathMode::kBlending, 0.02,
                                0.05},
                    StartupCase{"mm", "g21 g64p.02", PathMode::kBlending, 0.02, 0.02},
                    StartupCase{"mm", "G64", PathMode::kBlending, 0, 0},
                    StartupCase{"mm", "G20 G64 P0.001", PathMode::kBlending, 0.0254, 0.0254},
                    StartupCase{"inch", "G64 P0.001 Q0", PathMode::kBlending, 0.0254, 0},
                    StartupCase{"inch", "G64 P0.02 G21", PathMode::kBlending, 0.02, 0.02},
                    StartupCase{"mm", "G61", PathMode::kExactPath, 0, 0},
                    StartupCase{"mm", "G61.1 (stops)", PathMode::kExactStop, 0, 0},
                    StartupCase{"mm", "G21 (G64 P5)", PathMode::kBlending, 0, 0}));

TEST(MachineIni, TakesTheLimitsOfAJointWhereAnAxisHasNone) {
  const Read result = read_text(
      "[KINS]\nKINEMATICS = trivkins coordinates=XYYZ kinstype=BOTH\n"
      "[TRAJ]\nCOORDINATES = X Y Z\nLINEAR_UNITS = mm\n"
      "[AXIS_X]\nMAX_VELOCITY = 10\nMAX_ACCELERATION = 100\n"
      "[JOINT_0]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 1\n"
      "[JOINT_1]\nMAX_VELOCITY = 20\nMAX_ACCELERATION = 200\n"
      "[JOINT_2]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 2\n"
      "[JOINT_3]\nMAX_VELOCITY = 30\nMAX_ACCELERATION = 300\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->axis(Axis::kX).velocity, 10);
  EXPECT_EQ(result.machine->axis(Axis::kY).velocity, 20);
  EXPECT_EQ(result.machine->axis(Axis::kZ).velocity, 30);
  EXPECT_EQ(result.machine->axis(Axis::kZ).acceleration, 300);
}

// Up to 2.7 the sections of joints were called AXIS_0, and the path's limit MAX_VELOCITY.
TEST(MachineIni, ReadsFilesOfOlderVersions) {
  const Read result = read_text(
      "[TRAJ]\nAXES = 4\nCOORDINATES = X Y Z A\nLINEAR_UNITS = inch\nANGULAR_UNITS = degree\n"
      "MAX_VELOCITY = 2\n"
      "[AXIS_0]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 10\n"
      "[AXIS_1]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 10\n"
      "[AXIS_2]\nMAX_VELOCITY = 0.5\nMAX_ACCELERATION = 5\n"
      "[AXIS_3]\nTYPE = ANGULAR\nMAX_VELOCITY = 90\nMAX_ACCELERATION = 360\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_NEAR(result.machine->path_feed, 50.8, 1e-9);
  EXPECT_NEAR(result.machine->axis(Axis::kZ).velocity, 12.7, 1e-9);
  EXPECT_NEAR(result.machine->axis(Axis::kA).velocity, 90, 1e-9) << "degrees are no inches";
  EXPECT_NEAR(result.machine->axis(Axis::kA).acceleration, 360, 1e-9);
}

TEST(MachineIni, OfALatheIsNotHeldBackByAnAxisThatItHasNot) {
  const Read result = read_text(
      "[TRAJ]\nCOORDINATES = X Z\nLINEAR_UNITS = mm\n"
      "[AXIS_X]\nMAX_VELOCITY = 500\nMAX_ACCELERATION = 9000\n"
      "[AXIS_Z]\nMAX_VELOCITY = 900\nMAX_ACCELERATION = 5000\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->max_velocity(), 500);
  EXPECT_EQ(result.machine->max_acceleration(), 5000);
}

TEST(MachineIni, WithoutALimitOfThePathHasNone) {
  const Read result = read_text(
      "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n"
      "[AXIS_X]\nMAX_VELOCITY = 500\nMAX_ACCELERATION = 9000\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->path_feed, Machine::kNone);
}

TEST(MachineIni, TakesTheDepthOfTheOptimiserForItsLookAhead) {
  const Read result =
      read_text(std::string(kMillimetres) + "[TRAJ]\nARC_BLEND_OPTIMIZATION_DEPTH = 100\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->look_ahead, 100);
}

TEST(MachineIni, ReadsIncludedFilesInTheirPlace) {
  const ScratchFolder folder;
  (void)folder.put("parts/axes.inc",
                   "[AXIS_X]\nMAX_VELOCITY = 25\nMAX_ACCELERATION = -2\n#INCLUDE none.inc\n");
  const std::string file = folder.put("my.ini",
                                      "[TRAJ]\nCOORDINATES = X\n#INCLUDE parts/axes.inc\n[TRAJ]\n"
                                      "LINEAR_UNITS = mm\n[AXIS_X]\nMAX_VELOCITY = 99\n");
  const Read result = read(folder, file);
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems,
            "parts/axes.inc:3:20: [AXIS_X]MAX_ACCELERATION: -2, expected above 0 (mm/s2)\n")
      << "the first of two values counts, and included files include no more";
}

// --- what is wrong -------------------------------------------------------------------------------

struct BadIni {
  const char* name;
  const char* text;
  const char* problems;
};

class BadInis : public testing::TestWithParam<BadIni> {};

TEST_P(BadInis, AreToldWithPlaceAndValue) {
  const Read result = read_text(GetParam().text);
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, GetParam().problems);
}

constexpr const char* kNoUnits =
    "my.ini: no [TRAJ]LINEAR_UNITS, so its lengths mean nothing; expected mm or inch\n";

INSTANTIATE_TEST_SUITE_P(
    MachineIni, BadInis,
    testing::Values(
        BadIni{"NoUnits",
               "[TRAJ]\nCOORDINATES = X\n[AXIS_X]\nMAX_VELOCITY = 5\nMAX_ACCELERATION = 5\n",
               kNoUnits},
        BadIni{"WrongUnits",
               "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = furlong\n[AXIS_X]\nMAX_VELOCITY = 5\n"
               "MAX_ACCELERATION = 5\n",
               "my.ini:3:16: [TRAJ]LINEAR_UNITS: furlong, expected one of mm, metric, in, inch, "
               "imperial\n"},
        BadIni{"NoVelocity",
               "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_ACCELERATION = 5\n",
               "my.ini: no MAX_VELOCITY for axis X, expected in [AXIS_X]\n"},
        BadIni{"VelocityThatIsNoNumber",
               "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_VELOCITY = fast\n"
               "MAX_ACCELERATION = 5\n",
               "my.ini:5:16: [AXIS_X]MAX_VELOCITY: fast, expected a number\n"},
        BadIni{"ZeroVelocity",
               "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_VELOCITY = 0\n"
               "MAX_ACCELERATION = 5\n",
               "my.ini:5:16: [AXIS_X]MAX_VELOCITY: 0, expected above 0 (mm/s)\n"},
        BadIni{"ZeroPeriod",
               "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_VELOCITY = 1\n"
               "MAX_ACCELERATION = 5\n[EMCMOT]\nSERVO_PERIOD = 0\n",
               "my.ini:8:16: [EMCMOT]SERVO_PERIOD: 0, expected above 0 (s)\n"},
        BadIni{"NoDepth",
               "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\nARC_BLEND_OPTIMIZATION_DEPTH = 0\n"
               "[AXIS_X]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 5\n",
               "my.ini:4:32: [TRAJ]ARC_BLEND_OPTIMIZATION_DEPTH: 0, expected 1 or more (blocks)\n"},
        BadIni{"NoMachine", "[settings]\ncolour = red\n",
               "my.ini: no [TRAJ]LINEAR_UNITS, so its lengths mean nothing; expected mm or inch\n"
               "my.ini: no X, Y or Z in [TRAJ]COORDINATES and no [AXIS_X]: not the INI of a "
               "machine\n"},
        BadIni{"IncludeOfNothing", "#INCLUDE\n", "my.ini:1: #INCLUDE: there is no file ''\n"},
        BadIni{"IncludeOfAMissingFile", "[TRAJ]\n#INCLUDE  more.inc\n",
               "my.ini:2: #INCLUDE: there is no file 'more.inc'\n"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(MachineIni, ThatIsNotThereIsTold) {
  const ScratchFolder folder;
  const Read result = read(folder, folder.file("none.ini"));
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems.find("none.ini"), 0u) << result.problems;
}

}  // namespace
}  // namespace batten::postproc
