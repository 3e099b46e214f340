// The printer.cfg of a machine with Klipper.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/machine.h"
#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

struct ReadCfg {
  std::shared_ptr<const Machine> machine;
  std::string problems;  // one a line, without the folder
};

ReadCfg read_cfg(std::string_view text) {
  const ScratchFolder folder;
  std::vector<std::string> problems;
  ReadCfg result;
  result.machine = choose_machine(folder.put("printer.cfg", text), "--machine", problems);
  for (const std::string& problem : problems) {
    result.problems += folder.without_folder(problem) + "\n";
  }
  return result;
}

TEST(PrinterCfg, SaysTheLimitsOfAMachine) {
  const ReadCfg result = read_cfg(
      "# the router\n[mcu]\nserial: /dev/ttyUSB0\n\n[printer]\nkinematics: cartesian\n"
      "max_velocity: 300   # mm/s\nmax_accel = 3000\nmax_z_velocity:15\nmax_z_accel: 100 ; slow\n"
      "square_corner_velocity: 4.5\nminimum_cruise_ratio: 0.25\n\n[gcode_arcs]\nresolution: 0.1\n"
      "[gcode_macro START]\ngcode:\n    G28\n    max_velocity: 5\n"
      "#*# <---- SAVE_CONFIG ---->\n#*# [printer]\n#*# max_velocity = 7\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  const Machine& m = *result.machine;
  EXPECT_EQ(m.name, "printer");
  EXPECT_EQ(m.model, ControllerModel::kKlipper);
  EXPECT_EQ(m.path_feed, 300);
  EXPECT_EQ(m.path_acceleration, 3000);
  EXPECT_EQ(m.axis(Axis::kX).velocity, 300);
  EXPECT_EQ(m.axis(Axis::kX).rapid_velocity, 300);
  EXPECT_EQ(m.axis(Axis::kY).acceleration, 3000);
  EXPECT_EQ(m.axis(Axis::kZ).velocity, 15);
  EXPECT_EQ(m.axis(Axis::kZ).acceleration, 100);
  EXPECT_EQ(m.square_corner_velocity, 4.5);
  EXPECT_EQ(m.minimum_cruise_ratio, 0.25);
  EXPECT_EQ(m.arc_resolution, 0.1);
}

TEST(PrinterCfg, HasKlippersDefaultsElse) {
  const ReadCfg result = read_cfg("[printer]\nmax_velocity: 200\nmax_accel: 1000\n");
  ASSERT_NE(result.machine, nullptr) << result.problems;
  EXPECT_EQ(result.machine->axis(Axis::kZ).velocity, 200);
  EXPECT_EQ(result.machine->axis(Axis::kZ).acceleration, 1000);
  EXPECT_EQ(result.machine->square_corner_velocity, 5);
  EXPECT_EQ(result.machine->minimum_cruise_ratio, 0.5);
  EXPECT_EQ(result.machine->arc_resolution, 1);
}

// Older files say the acceleration of smoothed speeds: 400 of 1000 are a ratio of 0.6.
TEST(PrinterCfg, UnderstandsTheOlderWordForTheRatio) {
  const auto ratio = [](const std::string& line) {
    const ReadCfg result = read_cfg("[printer]\nmax_velocity: 200\nmax_accel: 1000\n" + line);
    return result.machine == nullptr ? -1 : result.machine->minimum_cruise_ratio;
  };
  EXPECT_DOUBLE_EQ(ratio("max_accel_to_decel: 400\n"), 0.6);
  EXPECT_DOUBLE_EQ(ratio("max_accel_to_decel: 2000\n"), 0);
  EXPECT_DOUBLE_EQ(ratio("max_accel_to_decel: 400\nminimum_cruise_ratio: 0.1\n"), 0.1);
}

TEST(PrinterCfg, SaysWhatIsWrongWithPosition) {
  EXPECT_EQ(read_cfg("[mcu]\n").problems,
            "printer.cfg: no [printer] in it or what it includes, expected the file that has it\n");
  EXPECT_EQ(read_cfg("[printer]\nmax_velocity: fast\nmax_accel: 1\n").problems,
            "printer.cfg:2:15: [printer] max_velocity: fast, expected a number\n");
  EXPECT_EQ(read_cfg("[printer]\nmax_velocity: 5\n").problems,
            "printer.cfg: no max_accel in [printer]\n");
  EXPECT_EQ(read_cfg("[printer]\nmax_velocity: 5\nmax_accel: 0\n").problems,
            "printer.cfg:3:12: [printer] max_accel: 0, expected above 0 (mm/s2)\n");
  EXPECT_EQ(
      read_cfg("[printer]\nmax_velocity: 5\nmax_accel: 9\nminimum_cruise_ratio: 1\n").problems,
      "printer.cfg:4:23: [printer] minimum_cruise_ratio: 1, expected 0 or more, below 1 (share)\n");
}

}  // namespace
}  // namespace batten::postproc
