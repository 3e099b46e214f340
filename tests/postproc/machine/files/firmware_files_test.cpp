// Machines of firmware from its own settings: Marlin's answer to M503, RepRapFirmware's config.g,
// FluidNC's YAML, and a printer.cfg in several files.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "postproc/machine/files/machine_file.h"
#include "postproc/machine/machine.h"
#include "tests/support/scratch_folder.h"

namespace batten::postproc {
namespace {

class FirmwareFile : public testing::Test {
 protected:
  // Null where something is wrong, which is in `problems_` then.
  std::shared_ptr<const Machine> read(const std::string& name, std::string_view text) {
    return choose(folder_.put(name, text));
  }
  std::shared_ptr<const Machine> choose(const std::string& file) {
    std::vector<std::string> problems;
    auto machine = choose_machine(file, "--machine", problems);
    problems_.clear();
    for (const std::string& problem : problems) {
      problems_ += folder_.without_folder(problem) + "\n";
    }
    return machine;
  }

  ScratchFolder folder_;
  std::string problems_;
};

constexpr const char* kM503 =
    "Send: M503\r\n"
    "echo:; Linear Units:\r\n"
    "echo:  G21 ; (mm)\r\n"
    "echo:; Steps per unit:\r\n"
    "echo: M92 X80.00 Y80.00 Z400.00 E93.00\r\n"
    "echo:; Max feedrates (units/s):\r\n"
    "echo:  M203 X100.00 Y90.00 Z5.00 E25.00\r\n"
    "echo:; Max Acceleration (units/s2):\r\n"
    "echo:  M201 X500.00 Y400.00 Z100.00 E5000.00\r\n"
    "echo:  M204 P300.00 R500.00 T200.00\r\n"
    "echo:; Advanced (B<min_segment_time_us> S<min_feedrate> T<min_travel_feedrate>):\r\n"
    "echo:  M205 B20000.00 S0.00 T0.00 J0.02\r\n"
    "ok\r\n";

TEST_F(FirmwareFile, MarlinsAnswerToM503) {
  const auto m = read("marlin.txt", kM503);
  ASSERT_NE(m, nullptr) << problems_;
  EXPECT_EQ(m->model, ControllerModel::kMarlin);
  EXPECT_EQ(m->name, "marlin");
  EXPECT_EQ(m->axis(Axis::kX).steps, 80);
  EXPECT_EQ(m->axis(Axis::kZ).steps, 400);
  EXPECT_EQ(m->axis(Axis::kY).velocity, 90);
  EXPECT_EQ(m->axis(Axis::kY).rapid_velocity, 90);
  EXPECT_EQ(m->axis(Axis::kX).acceleration, 500);
  EXPECT_EQ(m->path_acceleration, 200);  // T: of moves that extrude nothing
  EXPECT_EQ(m->junction_deviation, 0.02);
  EXPECT_EQ(m->axis(Axis::kX).velocity_step, Machine::kNone);
}

TEST_F(FirmwareFile, MarlinWithClassicJerk) {
  const auto m =
      read("old.txt",
           "echo:Maximum feedrates (mm/s):\necho:  M203 X300 Y300 Z5\n"
           "echo:  M201 X1000 Y1000 Z100\necho:  M205 S0 T0 B20000 X10.00 Y8.00 Z0.40\n");
  ASSERT_NE(m, nullptr) << problems_;
  EXPECT_EQ(m->axis(Axis::kX).velocity_step, 10);
  EXPECT_EQ(m->axis(Axis::kZ).velocity_step, 0.4);
  EXPECT_EQ(m->path_acceleration, Machine::kNone);
}

TEST_F(FirmwareFile, MarlinsMistakesAreToldWithTheirPlace) {
  EXPECT_EQ(read("a.txt", "hello\n"), nullptr);
  EXPECT_EQ(problems_, "a.txt: no M203 in it, expected what Marlin answers to M503\n");
  EXPECT_EQ(read("b.txt", "echo:  M203 X1 Yfast Z1\necho:  M201 X1 Y1\n"), nullptr);
  EXPECT_EQ(problems_, "b.txt:1:17: M203 Y: fast, expected a number\nb.txt: no M201 Z\n");
  EXPECT_EQ(read("c.txt", "M203 X1 Y0 Z1\nM201 X1 Y1 Z1\n"), nullptr);
  EXPECT_EQ(problems_, "c.txt:1:10: M203 Y: 0, expected above 0 (mm/s)\n");
  EXPECT_EQ(read("d.txt", "G20\nM203 X1 Y1 Z1\nM201 X1 Y1 Z1\n"), nullptr);
  EXPECT_EQ(problems_, "d.txt: G20: its numbers are in inches, expected millimetres\n");
}

TEST_F(FirmwareFile, RepRapFirmwaresConfig) {
  const auto m = read("config.g",
                      "; a router\nG90\nM92 X160 Y160 Z400 ; steps\nM566 X900.00 Y600.00 Z12.00\n"
                      "M203 X6000.00 Y6000.00 Z180.00\nM201 X500 Y400 Z20\nM204 P1500 T2000\n"
                      "m203 z240\n");
  ASSERT_NE(m, nullptr) << problems_;
  EXPECT_EQ(m->axis(Axis::kX).velocity, 100);
  EXPECT_EQ(m->axis(Axis::kZ).velocity, 4);  // the last one
  EXPECT_EQ(m->axis(Axis::kY).acceleration, 400);
  EXPECT_EQ(m->axis(Axis::kY).velocity_step, 10);
  EXPECT_EQ(m->axis(Axis::kX).steps, Machine::kNone);
  EXPECT_EQ(m->path_acceleration, 2000);
  EXPECT_EQ(read("config.g", "M203 X1 Y1 Z1\nM201 X1 Y1 Z1\n"), nullptr);
  EXPECT_EQ(problems_, "config.g: no M566 X\nconfig.g: no M566 Y\nconfig.g: no M566 Z\n");
}

constexpr const char* kYaml =
    "name: \"Router\"\nboard: MKS-DLC32\n"
    "axes:\n  shared_stepper_disable_pin: gpio.0:low\n"
    "  x:\n    steps_per_mm: 80.000\n    max_rate_mm_per_min: 6000.000  # fast\n"
    "    acceleration_mm_per_sec2: 500\n    motor0:\n      hard_limits: false\n"
    "  y:\n    steps_per_mm: 80\n    max_rate_mm_per_min: 5000\n    acceleration_mm_per_sec2: 400\n"
    "  z:\n    steps_per_mm: 400\n    max_rate_mm_per_min: 600\n    acceleration_mm_per_sec2: 100\n"
    "arc_tolerance_mm: 0.004\njunction_deviation_mm: 0.02\nplanner_blocks: 40\n";

TEST_F(FirmwareFile, FluidncsYaml) {
  const auto m = read("config.yaml", kYaml);
  ASSERT_NE(m, nullptr) << problems_;
  EXPECT_EQ(m->model, ControllerModel::kGrbl);
  EXPECT_EQ(m->axis(Axis::kX).velocity, 100);
  EXPECT_EQ(m->axis(Axis::kX).acceleration, 500);
  EXPECT_EQ(m->axis(Axis::kY).acceleration, 400);
  EXPECT_EQ(m->axis(Axis::kZ).rapid_velocity, 10);
  EXPECT_EQ(m->axis(Axis::kZ).steps, 400);
  EXPECT_EQ(m->arc_tolerance, 0.004);
  EXPECT_EQ(m->junction_deviation, 0.02);
  EXPECT_EQ(m->look_ahead, 40);
  std::string text = kYaml;
  text.replace(text.find("400\n  z"), 3, "no");
  EXPECT_EQ(read("config.yml", text), nullptr);
  EXPECT_EQ(problems_,
            "config.yml:14:31: axes/y/acceleration_mm_per_sec2: no, expected a number\n");
  EXPECT_EQ(read("config.yaml", "axes:\n  x:\n    steps_per_mm: 1\n"), nullptr);
  EXPECT_NE(problems_.find("config.yaml: no axes/x/max_rate_mm_per_min\n"), std::string::npos);
}

TEST_F(FirmwareFile, APrinterCfgInSeveralFiles) {
  folder_.put("parts/b.cfg", "[printer]\nmax_accel: 2000\nsquare_corner_velocity: 3\n");
  folder_.put("parts/a.cfg", "[printer]\nmax_accel: 1000\n");
  folder_.put("arcs.cfg", "[gcode_arcs]\nresolution: 0.2\n");
  const auto m = read("printer.cfg",
                      "[printer]\nmax_velocity: 200\nsquare_corner_velocity: 4\n"
                      "[include parts/*.cfg]\n[include arcs.cfg]\n");
  ASSERT_NE(m, nullptr) << problems_;
  EXPECT_EQ(m->path_acceleration, 2000);  // the last one: of parts/b.cfg
  EXPECT_EQ(m->square_corner_velocity, 3);
  EXPECT_EQ(m->arc_resolution, 0.2);
}

TEST_F(FirmwareFile, WhatIsWrongInAnIncludedFileIsToldThere) {
  folder_.put("limits.cfg", "[printer]\nmax_velocity: fast\nmax_accel: 0\n");
  EXPECT_EQ(read("printer.cfg", "[include limits.cfg]\n"), nullptr);
  EXPECT_EQ(problems_, "limits.cfg:2:15: [printer] max_velocity: fast, expected a number\n");
  folder_.put("limits.cfg", "[printer]\nmax_velocity: 5\nmax_accel: 0\n");
  EXPECT_EQ(read("printer.cfg", "[include limits.cfg]\n"), nullptr);
  EXPECT_EQ(problems_, "limits.cfg:3:12: [printer] max_accel: 0, expected above 0 (mm/s2)\n");
  folder_.put("limits.cfg", "[include printer.cfg]\n");
  EXPECT_EQ(read("printer.cfg", "[include limits.cfg]\n"), nullptr);
  EXPECT_EQ(problems_, "limits.cfg:1: [include]: 'printer.cfg' is being read already\n");
  EXPECT_EQ(read("printer.cfg", "[include nowhere.cfg]\n"), nullptr);
  EXPECT_EQ(problems_, "printer.cfg:1: [include]: there is no file 'nowhere.cfg'\n");
}

}  // namespace
}  // namespace batten::postproc
