// Machines from files: TOML, the INI of LinuxCNC, and what grbl answers to $$.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/machine_fields.h"
#include "tests/support/machine_limits.h"
#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

using gcode::PathMode;

struct Read {
  std::shared_ptr<const Machine> machine;
  std::string problems;  // one a line, without the folder
};

std::string lines_of(const ScratchFolder& folder, const std::vector<std::string>& problems) {
  std::string lines;
  for (const std::string& problem : problems) lines += folder.without_folder(problem) + "\n";
  return lines;
}

// By its suffix, as --machine does.
Read read(const ScratchFolder& folder, const std::string& file) {
  std::vector<std::string> problems;
  const auto machine = choose_machine(file, "--machine", problems);
  return {machine, lines_of(folder, problems)};
}

Read read_toml(std::string_view text) {
  const ScratchFolder folder;
  return read(folder, folder.put("my.toml", text));
}

Read read_ini(std::string_view text) {
  const ScratchFolder folder;
  return read(folder, folder.put("my.ini", text));
}

Read read_dump(std::string_view dump) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  const auto machine =
      machine_with_grbl_settings(find_machine("router"), folder.put("dump.txt", dump), problems);
  return {machine, lines_of(folder, problems)};
}

// Of a file in which nothing is wrong.
Machine machine_of(const Read& result) {
  EXPECT_EQ(result.problems, "");
  return result.machine == nullptr ? Machine{} : *result.machine;
}

// --- TOML: what a file says ----------------------------------------------------------------------

TEST(MachineFile, ChangesWhatDiffersFromItsBase) {
  const Machine m = machine_of(
      read_toml("based-on = \"linuxcnc\"\nmax-velocity = 200\nmax-acceleration = 1500\n"
                "rapid-velocity = 250\nblock-period = 0.002\nlook-ahead = 100\n"
                "junction-deviation = 0.02\narc-tolerance = 0.003\nblend-tolerance = 0.05\n"
                "naive-cam-tolerance = 0\n"));
  Machine expected = *find_machine("linuxcnc");
  expected.name = "my";
  expected.description = m.description;
  expected.source = m.source;
  set_max_velocity(expected, 200);
  set_max_acceleration(expected, 1500);
  set_rapid_velocity(expected, 250);
  expected.block_period = 0.002;
  expected.look_ahead = 100;
  expected.junction_deviation = 0.02;
  expected.arc_tolerance = 0.003;
  expected.blend_tolerance = 0.05;
  expected.naive_cam_tolerance = 0;
  EXPECT_EQ(m, expected);
}

TEST(MachineFile, SaysEachAxisForItself) {
  const Machine m = machine_of(
      read_toml("based-on = \"mill\"\nname = \"five axes\"\nmax-jerk = \"20 m/s3\"\n"
                "max-velocity = \"12 m/min\"\n[axis.z]\nvelocity = \"6000 mm/min\"\n"
                "rapid-velocity = 150\n[axis.a]\nvelocity = \"10 rpm\"\nacceleration = 300\n"
                "jerk = inf\n"));
  EXPECT_EQ(m.name, "five axes");
  EXPECT_NEAR(m.axis(Axis::kX).velocity, 200, 1e-12);
  EXPECT_NEAR(m.axis(Axis::kY).velocity, 200, 1e-12);
  EXPECT_NEAR(m.axis(Axis::kZ).velocity, 100, 1e-12);
  EXPECT_EQ(m.axis(Axis::kZ).rapid_velocity, 150);
  EXPECT_EQ(m.axis(Axis::kZ).jerk, 20000);
  EXPECT_NEAR(m.axis(Axis::kA).velocity, 60, 1e-12);
  EXPECT_EQ(m.axis(Axis::kA).acceleration, 300);
  EXPECT_EQ(m.axis(Axis::kA).jerk, Machine::kNone);
  EXPECT_EQ(m.axis(Axis::kB), find_machine("mill")->axis(Axis::kB));
}

TEST(MachineFile, SaysHowBlocksComeIn) {
  const Machine m = machine_of(
      read_toml("based-on = \"old-mill\"\nblock-rate = 250\nstream-rate = \"9600 baud\"\n"
                "path-mode = \"exact-stop\"\ntool-change-time = \"0.5 min\"\n"));
  EXPECT_DOUBLE_EQ(m.block_period, 0.004);
  EXPECT_DOUBLE_EQ(m.stream_rate, 960);
  EXPECT_EQ(m.path_mode, PathMode::kExactStop);
  EXPECT_DOUBLE_EQ(m.tool_change_time, 30);
}

TEST(MachineFile, MayBeBasedOnAnotherBesideIt) {
  const ScratchFolder folder;
  (void)folder.put("shop/mill.toml", "based-on = \"mill\"\nmax-velocity = 100\nlook-ahead = 7\n");
  const std::string file =
      folder.put("shop/slow.toml", "based-on = \"mill.toml\"\nmax-velocity = 50\n");
  const Read result = read(folder, file);
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->max_velocity(), 50);
  EXPECT_EQ(result.machine->look_ahead, 7);
  EXPECT_EQ(result.machine->name, "slow");
}

TEST(MachineFile, SaysWhatIsWrongWithTheFileThatItIsBasedOn) {
  const ScratchFolder folder;
  (void)folder.put("a.toml", "based-on = \"b.toml\"\n");
  Read result = read(folder, folder.put("b.toml", "based-on = \"./a.toml\"\n"));
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, "a.toml:1:12: based-on: b.toml is based on itself\n");
  (void)folder.put("base.toml", "based-on = \"mill\"\nmax-velocity = 0\n");
  result = read(folder, folder.put("my.toml", "based-on = \"base.toml\"\n"));
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, "base.toml:2:16: max-velocity: 0, expected above 0 (mm/s)\n");
}

// --- there and back ------------------------------------------------------------------------------

TEST(MachineFile, OfABuiltInMachineIsTheSameMachine) {
  for (const Machine& machine : built_in_machines()) {
    const Machine m = machine_of(read_toml(machine_file_text(machine)));
    EXPECT_EQ(m, machine) << machine.name;
    EXPECT_EQ(machine_file_text(m), machine_file_text(machine));
  }
}

// Every member differs from what a machine has by itself, so that a forgotten one is seen.
TEST(MachineFile, KeepsEveryMemberThereAndBack) {
  Machine machine;
  machine.name = "a \"name\" \\ with C:\\signs";
  machine.description = "µm, 日本";
  machine.model = ControllerModel::kGrbl;
  machine.path_mode = PathMode::kExactPath;
  machine.look_ahead = 3;
  double value = 1.0 / 3;
  for (const MachineField& field : machine_fields()) machine.*field.place = value *= 1.1;
  machine.minimum_cruise_ratio = 0.7;  // below 1
  for (AxisLimits& limits : machine.axes) {
    for (const AxisField& field : axis_fields()) limits.*field.place = value *= 1.1;
  }
  const Machine m = machine_of(read_toml(machine_file_text(machine)));
  EXPECT_EQ(m, machine);
}

// --- what is wrong -------------------------------------------------------------------------------

// A bad line, after what makes a good file.
struct BadFile {
  const char* name;
  const char* text;
  const char* problem;
};

class BadToml : public testing::TestWithParam<BadFile> {};

TEST_P(BadToml, IsSaidWithPositionKeyValueAndWhatIsAllowed) {
  const Read result = read_toml(std::string("based-on = \"router\"\n") + GetParam().text);
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, std::string("my.toml:") + GetParam().problem + "\n");
}

constexpr auto kName = [](const auto& test) { return std::string(test.param.name); };

INSTANTIATE_TEST_SUITE_P(
    MachineFile, BadToml,
    testing::Values(
        BadFile{"NegativeVelocity", "max-velocity = -200",
                "2:16: max-velocity: -200, expected above 0 (mm/s)"},
        BadFile{"ZeroAcceleration", "\nmax-acceleration = 0",
                "3:20: max-acceleration: 0, expected above 0 (mm/s2)"},
        BadFile{"EndlessRapid", "rapid-velocity = inf",
                "2:18: rapid-velocity: inf, expected above 0 (mm/s)"},
        BadFile{"NoNumber", "max-jerk = nan",
                "2:12: max-jerk: nan, expected above 0, or inf (mm/s3)"},
        BadFile{"OfOneAxis", "[axis.y]\nvelocity = -1",
                "3:12: axis.y.velocity: -1, expected above 0 (mm/s)"},
        BadFile{"OfARotaryAxis", "[axis.c]\nacceleration = 0",
                "3:16: axis.c.acceleration: 0, expected above 0 (deg/s2)"},
        BadFile{"NegativeWithAUnit", "[axis.x]\nvelocity = \"-600 mm/min\"",
                "3:12: axis.x.velocity: -10, expected above 0 (mm/s)"},
        BadFile{"AText", "max-velocity = \"fast\"",
                "2:16: max-velocity: \"fast\", expected a number (mm/s), or one with its unit as "
                "text: mm/s, mm/min, m/min, m/s, in/s, in/min, ipm"},
        BadFile{"AnotherUnit", "arc-tolerance = \"2 mm/s\"",
                "2:17: arc-tolerance: \"2 mm/s\", expected a number (mm), or one with its unit as "
                "text: mm, um, in, inch"},
        BadFile{"ALinearUnitOfARotaryAxis", "axis.a.velocity = \"5 mm/s\"",
                "2:19: axis.a.velocity: \"5 mm/s\", expected a number (deg/s), or one with its "
                "unit as text: deg/s, deg/min, rpm, rad/s"},
        BadFile{"AList", "max-velocity = [1, 2, 3]",
                "2:16: max-velocity: a list, expected a number (mm/s), or one with its unit as "
                "text: mm/s, mm/min, m/min, m/s, in/s, in/min, ipm"},
        BadFile{"ATruth", "servo-period = true",
                "2:16: servo-period: true, expected a number (s), or one with its unit as text: "
                "s, ms, us, min"},
        BadFile{"NoLookAhead", "look-ahead = 0",
                "2:14: look-ahead: 0, expected 1 or more (blocks)"},
        BadFile{"HalfALookAhead", "look-ahead = 1.5",
                "2:14: look-ahead: 1.5, expected a whole number above 0 (blocks)"},
        BadFile{"NoBlockPeriod", "block-period = 0", "2:16: block-period: 0, expected above 0 (s)"},
        BadFile{"NoBlockRate", "block-rate = 0",
                "2:14: block-rate: 0, expected above 0 (blocks/s)"},
        BadFile{"BlockRateAndPeriod", "block-rate = 1000\nblock-period = 0.001",
                "2:1: block-rate: block-period says the same in another way"},
        BadFile{"NoStream", "stream-rate = 0",
                "2:15: stream-rate: 0, expected above 0, or inf (bytes/s)"},
        BadFile{"NoPathFeed", "path-feed = 0",
                "2:13: path-feed: 0, expected above 0, or inf (mm/s)"},
        BadFile{"NoArcTolerance", "arc-tolerance = 0",
                "2:17: arc-tolerance: 0, expected above 0 (mm)"},
        BadFile{"NegativeBlend", "blend-tolerance = -1e-9",
                "2:19: blend-tolerance: -1e-09, expected 0 or more (mm)"},
        BadFile{"NegativeToolChange", "tool-change-time = -1",
                "2:20: tool-change-time: -1, expected 0 or more (s)"},
        BadFile{"EndlessRotaryVelocity", "[axis.c]\nvelocity = inf",
                "3:12: axis.c.velocity: inf, expected above 0 (deg/s)"},
        BadFile{"NoRotaryJerk", "[axis.a]\njerk = 0",
                "3:8: axis.a.jerk: 0, expected above 0, or inf (deg/s3)"},
        BadFile{"NegativeDwell", "extra-dwell-time = -0.1",
                "2:20: extra-dwell-time: -0.1, expected 0 or more (s)"},
        BadFile{"GrblWithoutJunctionDeviation", "junction-deviation = 0",
                "2:22: junction-deviation: 0, expected above 0 (mm)"},
        BadFile{"UnknownModel", "model = \"fanuc\"",
                "2:9: model: \"fanuc\", expected one of linuxcnc, grbl, grblhal, klipper, marlin, "
                "look-ahead"},
        BadFile{"UnknownPathMode", "path-mode = 61",
                "2:13: path-mode: 61, expected one of blend, exact-path, exact-stop"},
        BadFile{"NameThatIsNoText", "name = 5", "2:8: name: 5, expected a text in quotes"},
        BadFile{"SlipInAKey", "max-velocty = 5",
                "2:1: max-velocty: there is no such key, did you mean 'max-velocity'?"},
        BadFile{"SlipInAKeyOfAnAxis", "[axis.x]\nspeed = 1\n",
                "3:1: axis.x.speed: there is no such key; possible: velocity, acceleration, jerk, "
                "rapid-velocity, steps, velocity-step"},
        BadFile{"UnknownAxis", "[axis.u]\nvelocity = 1\n",
                "2:7: axis.u: there is no such axis; possible: x, y, z, a, b, c"},
        BadFile{"AxisThatIsNoTable", "axis.x = 5\n", "2:10: axis.x: 5, expected a table [axis.x]"},
        BadFile{"AxesThatAreNoTable", "axis = 5\n",
                "2:8: axis: 5, expected tables such as [axis.x]"}),
    kName);

TEST(MachineFile, SaysAllProblemsAtOnce) {
  const Read result =
      read_toml("based-on = \"mill\"\nmax-velocity = 0\nlook-ahed = 3\n[axis.x]\njerk = -5\n");
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(std::ranges::count(result.problems, '\n'), 3) << result.problems;
}

struct BadWhole {
  const char* text;
  const char* begins;    // its problem
  const char* contains;  // and
};

TEST(MachineFile, SaysWhatIsWrongWithItAsAWhole) {
  for (const auto& [text, begins, contains] : {
           BadWhole{"based-on = \"mill\"\nzzzzzzzz = 0\n",
                    "my.toml:2:1: zzzzzzzz:", "possible: based-on, name,"},
           BadWhole{"based-on = \"mill\"\nzzzzzzzz = 0\n", "", "tool-change-time"},
           BadWhole{"max-velocity = 5\nmodel = \"grbl\"\n", "my.toml: no based-on in it",
                    "axis.x.acceleration"},
           BadWhole{"based-on = \"mill\"\nmax-velocity = 5 mm\n", "my.toml:2:", ""},
           BadWhole{"based-on = \"rooter\"\n",
                    "my.toml:1:12: based-on: there is no machine 'rooter', did you mean 'router'?; "
                    "possible: linuxcnc, linuxcnc-fast, router, grblhal-router, router-unrounded, "
                    "klipper-router, marlin-router, grbl, mill, high-speed, old-mill, a file "
                    "NAME.toml, the NAME.ini of a LinuxCNC machine, the NAME.cfg of one with "
                    "Klipper, the NAME.yaml of one with FluidNC, the config.g of one with "
                    "RepRapFirmware, or a NAME.txt with what Marlin answers to M503\n",
                    ""},
       }) {
    const Read result = read_toml(text);
    EXPECT_EQ(result.machine, nullptr);
    EXPECT_TRUE(result.problems.starts_with(begins)) << result.problems;
    EXPECT_NE(result.problems.find(contains), std::string::npos) << result.problems;
  }
  EXPECT_EQ(read_toml("max-velocity = 5\n").problems.find("axis.x.velocity"), std::string::npos)
      << "that was given";
}

TEST(MachineFile, ThatIsNotThereIsSaid) {
  const ScratchFolder folder;
  for (const std::string name : {"none.toml", "none.ini"}) {
    const Read result = read(folder, folder.file(name));
    EXPECT_EQ(result.machine, nullptr);
    EXPECT_TRUE(result.problems.starts_with(name)) << result.problems;
  }
}

// --- the INI of LinuxCNC -------------------------------------------------------------------------

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

TEST(MachineIni, GivesLimitsInMillimetres) {
  for (const char* ini : {kMillimetres, kInches}) {
    const Machine m = machine_of(read_ini(ini));
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
    EXPECT_EQ(m.path_mode, PathMode::kBlending);
    EXPECT_EQ(m.blend_tolerance, 0.0254) << "as LinuxCNC starts";
    EXPECT_EQ(m.naive_cam_tolerance, 0);
  }
}

// Of one axis; more lines may follow.
std::string one_axis(const std::string& units) {
  return "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = " + units +
         "\n[AXIS_X]\nMAX_VELOCITY = 500\nMAX_ACCELERATION = 9000\n";
}

TEST(MachineIni, KnowsTheUnitsOfLinuxcnc) {
  for (const auto& [units, mm] :
       std::initializer_list<std::pair<const char*, double>>{{"mm", 1},
                                                             {"metric", 1},
                                                             {"in", 25.4},
                                                             {"inch", 25.4},
                                                             {"imperial", 25.4},
                                                             {"1.0", 1},
                                                             {"0.03937007874015748", 25.4}}) {
    const Machine m = machine_of(read_ini(one_axis(units)));
    EXPECT_NEAR(m.axis(Axis::kX).velocity, 500 * mm, 1e-9) << units;
    EXPECT_NEAR(m.axis(Axis::kX).acceleration, 9000 * mm, 1e-8) << units;
    EXPECT_EQ(m.path_feed, Machine::kNone) << "nothing said of the path";
  }
}

struct StartupCase {
  const char* units;  // of the machine
  const char* code;
  PathMode mode;
  double p;  // mm
  double q;
};

TEST(MachineIni, BlendsAsTheStartupCodeSays) {
  for (const StartupCase& c : {
           StartupCase{"mm", "G17 G21 G40 G49 G64 P0.02 Q0.05", PathMode::kBlending, 0.02, 0.05},
           StartupCase{"mm", "g21 g64p.02", PathMode::kBlending, 0.02, 0.02},
           StartupCase{"mm", "G64", PathMode::kBlending, 0, 0},
           StartupCase{"mm", "G20 G64 P0.001", PathMode::kBlending, 0.0254, 0.0254},
           StartupCase{"inch", "G64 P0.001 Q0", PathMode::kBlending, 0.0254, 0},
           StartupCase{"inch", "G64 P0.02 G21", PathMode::kBlending, 0.02, 0.02},
           StartupCase{"mm", "G61", PathMode::kExactPath, 0.0254, 0},
           StartupCase{"mm", "G61.1 (stops)", PathMode::kExactStop, 0.0254, 0},
           StartupCase{"mm", "G21 (G64 P5)", PathMode::kBlending, 0.0254, 0},
       }) {
    SCOPED_TRACE(c.code);
    const Machine m = machine_of(
        read_ini(one_axis(c.units) + "[RS274NGC]\nRS274NGC_STARTUP_CODE = " + c.code + "\n"));
    EXPECT_EQ(m.path_mode, c.mode);
    EXPECT_NEAR(m.blend_tolerance, c.p, 1e-12);
    EXPECT_NEAR(m.naive_cam_tolerance, c.q, 1e-12);
  }
}

TEST(MachineIni, TakesTheLimitsOfAJointWhereAnAxisHasNone) {
  const Machine m =
      machine_of(read_ini("[KINS]\nKINEMATICS = trivkins coordinates=XYYZ kinstype=BOTH\n"
                          "[TRAJ]\nCOORDINATES = X Y Z\nLINEAR_UNITS = mm\n"
                          "[AXIS_X]\nMAX_VELOCITY = 10\nMAX_ACCELERATION = 100\n"
                          "[JOINT_0]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 1\n"
                          "[JOINT_1]\nMAX_VELOCITY = 20\nMAX_ACCELERATION = 200\n"
                          "[JOINT_2]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 2\n"
                          "[JOINT_3]\nMAX_VELOCITY = 30\nMAX_ACCELERATION = 300\n"));
  EXPECT_EQ(m.axis(Axis::kX).velocity, 10);
  EXPECT_EQ(m.axis(Axis::kY).velocity, 20);
  EXPECT_EQ(m.axis(Axis::kZ).velocity, 30);
  EXPECT_EQ(m.axis(Axis::kZ).acceleration, 300);
}

// Up to 2.7 the sections of joints were called AXIS_0, and the path's limit MAX_VELOCITY.
TEST(MachineIni, ReadsFilesOfOlderVersions) {
  const Machine m = machine_of(read_ini(
      "[TRAJ]\nAXES = 4\nCOORDINATES = X Y Z A\nLINEAR_UNITS = inch\nANGULAR_UNITS = degree\n"
      "MAX_VELOCITY = 2\n"
      "[AXIS_0]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 10\n"
      "[AXIS_1]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 10\n"
      "[AXIS_2]\nMAX_VELOCITY = 0.5\nMAX_ACCELERATION = 5\n"
      "[AXIS_3]\nTYPE = ANGULAR\nMAX_VELOCITY = 90\nMAX_ACCELERATION = 360\n"));
  EXPECT_NEAR(m.path_feed, 50.8, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kZ).velocity, 12.7, 1e-9);
  EXPECT_NEAR(m.axis(Axis::kA).velocity, 90, 1e-9) << "degrees are no inches";
  EXPECT_NEAR(m.axis(Axis::kA).acceleration, 360, 1e-9);
}

TEST(MachineIni, OfALatheIsNotHeldBackByAnAxisThatItHasNot) {
  const Machine m =
      machine_of(read_ini("[TRAJ]\nCOORDINATES = X Z\nLINEAR_UNITS = mm\n"
                          "[AXIS_X]\nMAX_VELOCITY = 500\nMAX_ACCELERATION = 9000\n"
                          "[AXIS_Z]\nMAX_VELOCITY = 900\nMAX_ACCELERATION = 5000\n"));
  EXPECT_EQ(m.max_velocity(), 500);
  EXPECT_EQ(m.max_acceleration(), 5000);
}

TEST(MachineIni, TakesTheDepthOfTheOptimiserForItsLookAhead) {
  const Machine m = machine_of(
      read_ini(std::string(kMillimetres) + "[TRAJ]\nARC_BLEND_OPTIMIZATION_DEPTH = 100\n"));
  EXPECT_EQ(m.look_ahead, 100);
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

class BadIni : public testing::TestWithParam<BadFile> {};

TEST_P(BadIni, IsSaidWithPositionAndValue) {
  const Read result = read_ini(GetParam().text);
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, GetParam().problem);
}

INSTANTIATE_TEST_SUITE_P(
    MachineIni, BadIni,
    testing::Values(
        BadFile{
            "NoUnits",
            "[TRAJ]\nCOORDINATES = X\n[AXIS_X]\nMAX_VELOCITY = 5\nMAX_ACCELERATION = 5\n",
            "my.ini: no [TRAJ]LINEAR_UNITS, so its lengths mean nothing; expected mm or inch\n"},
        BadFile{"WrongUnits",
                "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = furlong\n[AXIS_X]\nMAX_VELOCITY = 5\n"
                "MAX_ACCELERATION = 5\n",
                "my.ini:3:16: [TRAJ]LINEAR_UNITS: furlong, expected one of mm, metric, in, inch, "
                "imperial\n"},
        BadFile{"NoVelocity",
                "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_ACCELERATION = 5\n",
                "my.ini: no MAX_VELOCITY for axis X, expected in [AXIS_X]\n"},
        BadFile{"VelocityThatIsNoNumber",
                "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_VELOCITY = fast\n"
                "MAX_ACCELERATION = 5\n",
                "my.ini:5:16: [AXIS_X]MAX_VELOCITY: fast, expected a number\n"},
        BadFile{"ZeroVelocity",
                "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_VELOCITY = 0\n"
                "MAX_ACCELERATION = 5\n",
                "my.ini:5:16: [AXIS_X]MAX_VELOCITY: 0, expected above 0 (mm/s)\n"},
        BadFile{"ZeroPeriod",
                "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n[AXIS_X]\nMAX_VELOCITY = 1\n"
                "MAX_ACCELERATION = 5\n[EMCMOT]\nSERVO_PERIOD = 0\n",
                "my.ini:8:16: [EMCMOT]SERVO_PERIOD: 0, expected above 0 (s)\n"},
        BadFile{
            "NoDepth",
            "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\nARC_BLEND_OPTIMIZATION_DEPTH = 0\n"
            "[AXIS_X]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 5\n",
            "my.ini:4:32: [TRAJ]ARC_BLEND_OPTIMIZATION_DEPTH: 0, expected 1 or more (blocks)\n"},
        BadFile{"NoMachine", "[settings]\ncolour = red\n",
                "my.ini: no [TRAJ]LINEAR_UNITS, so its lengths mean nothing; expected mm or inch\n"
                "my.ini: no X, Y or Z in [TRAJ]COORDINATES and no [AXIS_X]: not the INI of a "
                "machine\n"},
        BadFile{"IncludeOfNothing", "#INCLUDE\n", "my.ini:1: #INCLUDE: there is no file ''\n"},
        BadFile{"IncludeOfAMissingFile", "[TRAJ]\n#INCLUDE  more.inc\n",
                "my.ini:2: #INCLUDE: there is no file 'more.inc'\n"}),
    kName);

// --- settings of grbl ----------------------------------------------------------------------------

// All that time depends on; each line may be replaced.
std::string dump_with(const std::string& line = "") {
  return "$11=0.020\r\n$12=0.003\r\n$110=5000.000\r\n$111=4000.000\r\n$112=600.000\r\n"
         "$120=300.000\r\n$121=250.000\r\n$122=50.000\r\n" +
         line;
}

void expect_the_machine_of_the_dump(const Machine& m) {
  EXPECT_EQ(m.model, ControllerModel::kGrbl);
  EXPECT_DOUBLE_EQ(m.junction_deviation, 0.02);
  EXPECT_DOUBLE_EQ(m.arc_tolerance, 0.003);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kX).velocity, 5000.0 / 60);  // $110 is in mm/min
  EXPECT_DOUBLE_EQ(m.axis(Axis::kY).velocity, 4000.0 / 60);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kZ).velocity, 10);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kZ).rapid_velocity, 10) << "grbl has one limit for both";
  EXPECT_DOUBLE_EQ(m.axis(Axis::kX).acceleration, 300);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kY).acceleration, 250);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kZ).acceleration, 50);
}

TEST(GrblSettings, AreThoseOfTheDumpAndElseOfTheBase) {
  const Machine m = machine_of(read_dump(dump_with()));
  expect_the_machine_of_the_dump(m);
  expect_the_machine_of_the_dump(machine_of(read_dump("$110=1\n" + dump_with())));  // the last
  const Machine& router = *find_machine("router");
  EXPECT_EQ(m.stream_rate, router.stream_rate);
  EXPECT_EQ(m.look_ahead, router.look_ahead);
  EXPECT_EQ(m.axis(Axis::kA), router.axis(Axis::kA));
}

// What stands around the settings in the log of a sender: all of it is passed over.
TEST(GrblSettings, StandAmongAnswersAndComments) {
  const std::string dump =
      "\xEF\xBB\xBF"
      "; saved by hand\n"
      "\n"
      "Grbl 1.1h ['$' for help]\n"
      "[MSG:'$H'|'$X' to unlock]\n"
      ">>> $$\n"
      "$$\n"
      "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\n"
      "$0=10\n$1=25 (step idle delay, msec)\n$13=1 (report inches, bool)\n$32=1\n"
      "  $11 = 0.020 (junction deviation, mm)\n"
      "$12=0.003 (arc tolerance, mm)\n"
      "$100=250.000 (x, step/mm)\n"
      "$110=5000.000 (x max rate, mm/min)\n$111=4000.000\n$112=600\n"
      "$120=300.000 (x accel, mm/sec^2)\n$121=250.000 ; mm/sec^2\n$122=50.000\n"
      "$130=800.000 (x max travel, mm)\n"
      "$N0=G21 G90\n"
      "ok\n";
  const Machine m = machine_of(read_dump(dump));
  expect_the_machine_of_the_dump(m);
}

// grblHAL: axes beyond Z, and settings that are texts or lists.
TEST(GrblSettings, OfGrblHalHaveMoreAxes) {
  const Machine m =
      machine_of(read_dump(dump_with("$70=7\n$74=home network\n$302=192.168.5.1\n$341=0\n"
                                     "$113=3600.000\n$123=500.000\n$660=,\n")));
  expect_the_machine_of_the_dump(m);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kA).velocity, 60);  // degrees/s
  EXPECT_DOUBLE_EQ(m.axis(Axis::kA).acceleration, 500);
}

// A line after eight good ones.
class BadDump : public testing::TestWithParam<BadFile> {};

TEST_P(BadDump, IsSaidWithPositionAndSetting) {
  const Read result = read_dump(dump_with(GetParam().text));
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, std::string("dump.txt:") + GetParam().problem + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    GrblSettings, BadDump,
    testing::Values(
        BadFile{"NoRate", "$110=0.000", "9:6: $110: 0, expected above 0 (mm/s)"},
        BadFile{"NegativeAcceleration", "  $122 = -5", "9:10: $122: -5, expected above 0 (mm/s2)"},
        BadFile{"NoJunctionDeviation", "$11=0", "9:5: $11: 0, expected above 0 (mm)"},
        BadFile{"NoNumber", "$12=abc", "9:1: '$12=abc', expected a setting such as $110=5000.000"},
        BadFile{"ACommaForThePoint", "$120=10,5",
                "9:1: '$120=10,5', expected a setting such as $110=5000.000"},
        BadFile{"Nothing", "$110=", "9:1: '$110=', expected a setting such as $110=5000.000"},
        BadFile{"AProgram", "G21 G90", "9:1: 'G21 G90', expected a setting such as $110=5000.000"},
        BadFile{"AnError", "error:8",
                "9:1: 'error:8' is what a control answers that prints no settings"},
        BadFile{"AnAlarm", "ALARM: 1",
                "9:1: 'ALARM: 1' is what a control answers that prints no settings"}),
    kName);

TEST(GrblSettings, ThatAreMissingAreToldTogether) {
  const Read result = read_dump("$11=0.010\n$110=500\n$111=500\n$120=10\n$121=10\n$122=10\nok\n");
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems,
            "dump.txt: no $12, $112 in it, expected all that grbl prints when asked for $$\n");
  EXPECT_EQ(read_dump("").machine, nullptr);
}

// --- the machine that a user names ---------------------------------------------------------------

TEST(ChooseMachine, ReadsFilesByTheirSuffix) {
  const ScratchFolder folder;
  EXPECT_EQ(read(folder, "mill").machine.get(), find_machine("mill"));
  const auto toml = folder.put("a.toml", "based-on = \"mill\"\nmax-velocity = 7\n");
  EXPECT_EQ(machine_of(read(folder, toml)).max_velocity(), 7);
  const auto ini = folder.put("B.INI", one_axis("mm"));
  EXPECT_EQ(machine_of(read(folder, ini)).axis(Axis::kX).velocity, 500);
  const auto both = folder.put("c.toml", "based-on = \"B.INI\"\ntool-change-time = 8\n");
  EXPECT_EQ(machine_of(read(folder, both)).axis(Axis::kX).velocity, 500);
  EXPECT_EQ(machine_of(read(folder, both)).tool_change_time, 8);
  EXPECT_EQ(read(folder, "ruter").problems,
            "--machine: there is no machine 'ruter', did you mean 'router'?; possible: linuxcnc, "
            "linuxcnc-fast, router, grblhal-router, router-unrounded, klipper-router, "
            "marlin-router, grbl, mill, high-speed, old-mill, a file NAME.toml, the NAME.ini of a "
            "LinuxCNC machine, the NAME.cfg of one with Klipper, the NAME.yaml of one with "
            "FluidNC, the config.g of one with RepRapFirmware, or a NAME.txt with what Marlin "
            "answers to M503\n");
}

// $100 to $102; a dump without them says nothing of steps.
TEST(MachineWithGrblSettings, HasTheStepsOfTheMotors) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  const auto with = [&](const std::string& lines) {
    return machine_with_grbl_settings(nullptr, folder.put("s.txt", dump_with(lines)), problems);
  };
  const auto machine = with("$100=320.000\r\n$101=400.000\r\n$102=800.000\r\n");
  ASSERT_NE(machine, nullptr) << problems.front();
  EXPECT_EQ(machine->axis(Axis::kX).steps, 320);
  EXPECT_EQ(machine->axis(Axis::kY).steps, 400);
  EXPECT_EQ(machine->axis(Axis::kZ).steps, 800);
  EXPECT_EQ(with("")->axis(Axis::kX).steps, find_machine("grbl")->axis(Axis::kX).steps);
  EXPECT_EQ(with("$100=0\r\n"), nullptr);
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems.front().find("$100: 0, expected above 0"), std::string::npos);
}

// Only grblHAL has $398, the blocks that it plans ahead.
TEST(MachineWithGrblSettings, AreThoseOfGrblhalWhereTheyHaveItsPlannerBlocks) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  const auto machine =
      machine_with_grbl_settings(nullptr, folder.put("s.txt", dump_with("$398=35\r\n")), problems);
  ASSERT_NE(machine, nullptr) << problems.front();
  EXPECT_EQ(machine->model, ControllerModel::kGrblhal);
  EXPECT_EQ(machine->look_ahead, 35);
}

// A complete file that was printed before machines had steps is still one.
TEST(MachineFile, NeedsNoStepsWithoutABase) {
  std::string text;
  std::istringstream lines(machine_file_text(*find_machine("mill")));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("steps =")) text += line + "\n";
  }
  EXPECT_EQ(machine_of(read_toml(text)), *find_machine("mill"));
}

TEST(MachineWithGrblSettings, TakesTheRestFromItsBase) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  Machine base = *find_machine("router");
  base.tool_change_time = 60;
  const std::string dump = folder.put("shapeoko.txt", dump_with());
  const auto machine = machine_with_grbl_settings(&base, dump, problems);
  ASSERT_NE(machine, nullptr);
  EXPECT_EQ(machine->name, "shapeoko");
  EXPECT_EQ(machine->tool_change_time, 60);
  expect_the_machine_of_the_dump(*machine);
  EXPECT_NE(machine_with_grbl_settings(nullptr, dump, problems), nullptr);
  EXPECT_TRUE(problems.empty());
  EXPECT_EQ(machine_with_grbl_settings(find_machine("mill"), dump, problems), nullptr);
  EXPECT_EQ(machine_with_grbl_settings(nullptr, folder.file("none.txt"), problems), nullptr);
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0],
            "--grbl-settings: the control of machine mill is look-ahead, expected a machine with "
            "grbl, such as router");
  EXPECT_TRUE(problems[1].starts_with("--grbl-settings: ")) << problems[1];
}

}  // namespace
}  // namespace batten::postproc
