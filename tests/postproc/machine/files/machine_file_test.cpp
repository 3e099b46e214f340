#include "postproc/machine/files/machine_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "postproc/machine/machine_fields.h"
#include "tests/support/machine_limits.h"
#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

struct Read {
  std::shared_ptr<const Machine> machine;
  std::string problems;  // one a line, without the folder
};

Read read(const ScratchFolder& folder, const std::string& file) {
  std::vector<std::string> problems;
  Read result{read_machine_file(file, problems), {}};
  for (const std::string& problem : problems) {
    result.problems += folder.without_folder(problem) + "\n";
  }
  return result;
}

Read read_text(std::string_view text) {
  const ScratchFolder folder;
  return read(folder, folder.put("my.toml", text));
}

// --- what a file says ----------------------------------------------------------------------------

TEST(MachineFile, ChangesWhatDiffersFromItsBase) {
  const Read result = read_text(
      "based-on = \"linuxcnc\"\n"
      "max-velocity = 200\n"
      "max-acceleration = 1500\n"
      "rapid-velocity = 250\n"
      "block-period = 0.002\n"
      "look-ahead = 100\n"
      "junction-deviation = 0.02\n"
      "arc-tolerance = 0.003\n"
      "blend-tolerance = 0.05\n"
      "naive-cam-tolerance = 0\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  Machine expected = *find_machine("linuxcnc");
  expected.name = "my";
  expected.description = result.machine->description;
  set_max_velocity(expected, 200);
  set_max_acceleration(expected, 1500);
  set_rapid_velocity(expected, 250);
  expected.block_period = 0.002;
  expected.look_ahead = 100;
  expected.junction_deviation = 0.02;
  expected.arc_tolerance = 0.003;
  expected.blend_tolerance = 0.05;
  expected.naive_cam_tolerance = 0;
  EXPECT_EQ(*result.machine, expected);
}

TEST(MachineFile, SaysEachAxisForItself) {
  const Read result = read_text(
      "based-on = \"mill\"\n"
      "name = \"five axes\"\n"
      "max-jerk = \"20 m/s3\"\n"
      "max-velocity = \"12 m/min\"\n"
      "[axis.z]\n"
      "velocity = \"6000 mm/min\"\n"
      "rapid-velocity = 150\n"
      "[axis.a]\n"
      "velocity = \"10 rpm\"\n"
      "acceleration = 300\n"
      "jerk = inf\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  const Machine& m = *result.machine;
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
  const Read result = read_text(
      "based-on = \"old-mill\"\n"
      "block-rate = 250\n"
      "stream-rate = \"9600 baud\"\n"
      "path-mode = \"exact-stop\"\n"
      "tool-change-time = \"0.5 min\"\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_DOUBLE_EQ(result.machine->block_period, 0.004);
  EXPECT_DOUBLE_EQ(result.machine->stream_rate, 960);
  EXPECT_EQ(result.machine->path_mode, gcode::PathMode::kExactStop);
  EXPECT_DOUBLE_EQ(result.machine->tool_change_time, 30);
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

TEST(MachineFile, MayNotBeBasedOnItself) {
  const ScratchFolder folder;
  (void)folder.put("a.toml", "based-on = \"b.toml\"\n");
  const std::string file = folder.put("b.toml", "based-on = \"./a.toml\"\n");
  const Read result = read(folder, file);
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, "a.toml:1:12: based-on: b.toml is based on itself\n");
}

TEST(MachineFile, TellsWhatIsWrongInTheFileThatItIsBasedOn) {
  const ScratchFolder folder;
  (void)folder.put("base.toml", "based-on = \"mill\"\nmax-velocity = 0\n");
  const Read result = read(folder, folder.put("my.toml", "based-on = \"base.toml\"\n"));
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, "base.toml:2:16: max-velocity: 0, expected above 0 (mm/s)\n");
}

// --- there and back ------------------------------------------------------------------------------

class RoundTrip : public testing::TestWithParam<std::string> {};

TEST_P(RoundTrip, OfABuiltInMachineIsTheSameMachine) {
  const Machine& machine = *find_machine(GetParam());
  const Read result = read_text(machine_file_text(machine));
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(*result.machine, machine);
  EXPECT_EQ(machine_file_text(*result.machine), machine_file_text(machine));
}

std::vector<std::string> names_of_machines() {
  std::vector<std::string> names;
  for (const Machine& machine : built_in_machines()) names.push_back(machine.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(MachineFile, RoundTrip, testing::ValuesIn(names_of_machines()));

// Every member differs from what a machine has by itself, so that a forgotten one is seen.
TEST(MachineFile, KeepsEveryMemberThereAndBack) {
  Machine machine;
  machine.name = "a \"name\" \\ with C:\\signs";
  machine.description = "µm, 日本";
  machine.model = ControllerModel::kGrbl;
  machine.path_mode = gcode::PathMode::kExactPath;
  machine.look_ahead = 3;
  double value = 1.0 / 3;
  for (const MachineField& field : machine_fields()) machine.*field.place = value *= 1.1;
  for (AxisLimits& limits : machine.axes) {
    for (const AxisField& field : axis_fields()) limits.*field.place = value *= 1.1;
  }
  const Read result = read_text(machine_file_text(machine));
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(*result.machine, machine);
}

// --- what is wrong -------------------------------------------------------------------------------

struct BadFile {
  const char* name;
  const char* text;
  const char* problem;
};

class BadFiles : public testing::TestWithParam<BadFile> {};

TEST_P(BadFiles, AreToldWithPlaceKeyValueAndWhatIsAllowed) {
  const Read result = read_text(std::string("based-on = \"router\"\n") + GetParam().text);
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems, std::string("my.toml:") + GetParam().problem + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    MachineFile, BadFiles,
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
        BadFile{"NegativeDwell", "extra-dwell-time = -0.1",
                "2:20: extra-dwell-time: -0.1, expected 0 or more (s)"},
        BadFile{"GrblWithoutJunctionDeviation", "junction-deviation = 0",
                "2:22: junction-deviation: 0, expected above 0 (mm)"},
        BadFile{"UnknownModel", "model = \"fanuc\"",
                "2:9: model: \"fanuc\", expected one of linuxcnc, grbl, look-ahead"},
        BadFile{"UnknownPathMode", "path-mode = 61",
                "2:13: path-mode: 61, expected one of blend, exact-path, exact-stop"},
        BadFile{"NameThatIsNoText", "name = 5", "2:8: name: 5, expected a text in quotes"},
        BadFile{"SlipInAKey", "max-velocty = 5",
                "2:1: max-velocty: there is no such key, did you mean 'max-velocity'?"},
        BadFile{"SlipInAKeyOfAnAxis", "[axis.x]\nspeed = 1\n",
                "3:1: axis.x.speed: there is no such key; possible: velocity, acceleration, jerk, "
                "rapid-velocity"},
        BadFile{"UnknownAxis", "[axis.u]\nvelocity = 1\n",
                "2:7: axis.u: there is no such axis; possible: x, y, z, a, b, c"},
        BadFile{"AxisThatIsNoTable", "axis.x = 5\n", "2:10: axis.x: 5, expected a table [axis.x]"},
        BadFile{"AxesThatAreNoTable", "axis = 5\n",
                "2:8: axis: 5, expected tables such as [axis.x]"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(MachineFile, TellsAllProblemsAtOnce) {
  const Read result =
      read_text("based-on = \"mill\"\nmax-velocity = 0\nlook-ahed = 3\n[axis.x]\njerk = -5\n");
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(std::count(result.problems.begin(), result.problems.end(), '\n'), 3) << result.problems;
}

TEST(MachineFile, TellsOfAKeyThatNothingIsLikeWhichKeysThereAre) {
  const Read result = read_text("based-on = \"mill\"\nzzzzzzzz = 0\n");
  EXPECT_NE(result.problems.find("possible: based-on, name,"), std::string::npos)
      << result.problems;
  EXPECT_NE(result.problems.find("tool-change-time"), std::string::npos) << result.problems;
}

TEST(MachineFile, NeedsABaseOrEverything) {
  const Read result = read_text("max-velocity = 5\nmodel = \"grbl\"\n");
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems.find("my.toml: no based-on in it"), 0u) << result.problems;
  EXPECT_NE(result.problems.find("axis.x.acceleration"), std::string::npos) << result.problems;
  EXPECT_EQ(result.problems.find("axis.x.velocity"), std::string::npos) << "that was given";
}

TEST(MachineFile, OfNoKnownBaseTellsTheChoices) {
  const Read result = read_text("based-on = \"rooter\"\n");
  EXPECT_EQ(result.problems,
            "my.toml:1:12: based-on: there is no machine 'rooter', did you mean 'router'?; "
            "possible: linuxcnc, router, grbl, mill, high-speed, old-mill, a file NAME.toml, or "
            "the NAME.ini of a LinuxCNC machine\n");
}

TEST(MachineFile, ThatIsNoTomlTellsWhere) {
  const Read result = read_text("based-on = \"mill\"\nmax-velocity = 5 mm\n");
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems.find("my.toml:2:"), 0u) << result.problems;
}

TEST(MachineFile, ThatIsNotThereIsTold) {
  const ScratchFolder folder;
  const Read result = read(folder, folder.file("none.toml"));
  EXPECT_EQ(result.machine, nullptr);
  EXPECT_EQ(result.problems.find("none.toml: "), 0u) << result.problems;
}

}  // namespace
}  // namespace batten::postproc
