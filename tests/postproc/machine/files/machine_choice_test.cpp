#include "postproc/machine/files/machine_file.h"

#include <gtest/gtest.h>

#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

constexpr const char* kIni =
    "[TRAJ]\nCOORDINATES = X\nLINEAR_UNITS = mm\n"
    "[AXIS_X]\nMAX_VELOCITY = 77\nMAX_ACCELERATION = 5\n";

constexpr const char* kDump =
    "$11=0.010\n$12=0.002\n$110=6000\n$111=6000\n$112=600\n$120=500\n$121=500\n$122=60\n";

TEST(ChooseMachine, GivesBuiltInOnesByName) {
  std::vector<std::string> problems;
  const auto machine = choose_machine("mill", "--machine", problems);
  EXPECT_EQ(machine.get(), find_machine("mill"));
  EXPECT_TRUE(problems.empty());
}

TEST(ChooseMachine, ReadsFilesByTheirSuffix) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  const auto toml = choose_machine(folder.put("a.toml", "based-on = \"mill\"\nmax-velocity = 7\n"),
                                   "--machine", problems);
  ASSERT_NE(toml, nullptr);
  EXPECT_EQ(toml->max_velocity(), 7);
  const auto ini = choose_machine(folder.put("B.INI", kIni), "--machine", problems);
  ASSERT_NE(ini, nullptr);
  EXPECT_EQ(ini->axis(Axis::kX).velocity, 77);
  EXPECT_TRUE(problems.empty());
}

TEST(ChooseMachine, LetsAFileBeBasedOnAnIni) {
  const ScratchFolder folder;
  (void)folder.put("mill.ini", kIni);
  std::vector<std::string> problems;
  const auto machine =
      choose_machine(folder.put("a.toml", "based-on = \"mill.ini\"\ntool-change-time = 8\n"),
                     "--machine", problems);
  ASSERT_NE(machine, nullptr) << problems.front();
  EXPECT_EQ(machine->axis(Axis::kX).velocity, 77);
  EXPECT_EQ(machine->tool_change_time, 8);
}

TEST(ChooseMachine, TellsTheChoices) {
  std::vector<std::string> problems;
  EXPECT_EQ(choose_machine("ruter", "--machine", problems), nullptr);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0],
            "--machine: there is no machine 'ruter', did you mean 'router'?; possible: linuxcnc, "
            "router, grbl, mill, high-speed, old-mill, a file NAME.toml, or the NAME.ini of a "
            "LinuxCNC machine");
}

TEST(MachineWithGrblSettings, TakesTheRestFromItsBase) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  Machine base = *find_machine("router");
  base.tool_change_time = 60;
  const auto machine =
      machine_with_grbl_settings(&base, folder.put("shapeoko.txt", kDump), problems);
  ASSERT_NE(machine, nullptr);
  EXPECT_EQ(machine->name, "shapeoko");
  EXPECT_EQ(machine->tool_change_time, 60);
  EXPECT_EQ(machine->axis(Axis::kX).velocity, 100);
  EXPECT_EQ(machine->axis(Axis::kZ).acceleration, 60);
  EXPECT_NE(machine_with_grbl_settings(nullptr, folder.file("shapeoko.txt"), problems), nullptr);
  EXPECT_TRUE(problems.empty());
}

TEST(MachineWithGrblSettings, RefusesAnotherControl) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  EXPECT_EQ(machine_with_grbl_settings(find_machine("mill"), folder.put("a.txt", kDump), problems),
            nullptr);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0],
            "--grbl-settings: the control of machine mill is look-ahead, expected a machine with "
            "grbl, such as router");
}

TEST(MachineWithGrblSettings, TellsOfAMissingFile) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  EXPECT_EQ(machine_with_grbl_settings(nullptr, folder.file("none.txt"), problems), nullptr);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].find("--grbl-settings: "), 0u) << problems[0];
}

}  // namespace
}  // namespace batten::postproc
