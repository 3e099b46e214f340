#include "postproc/options/target_on_machine.h"

#include <gtest/gtest.h>

#include "gcode/controls/built_in.h"

namespace batten::postproc {
namespace {

TEST(TargetOnMachine, HasTheSettingsByWhichTheMachineCutsArcs) {
  Machine router = *find_machine("router");
  router.arc_tolerance = 0.0005;
  for (const char* name : {"grbl", "grblhal", "fluidnc"}) {
    EXPECT_EQ(target_on_machine(*gcode::find_control(name), router)->chords.error, 0.0005) << name;
  }
  Machine printer = *find_machine("klipper-router");
  printer.arc_resolution = 0.1;
  EXPECT_EQ(target_on_machine(*gcode::find_control("klipper"), printer)->chords.longest, 0.1);
}

TEST(TargetOnMachine, IsTheTargetItselfWhereTheMachineSaysNothingElse) {
  Machine router = *find_machine("router");
  router.arc_tolerance = 0.0005;
  Machine printer = *find_machine("klipper-router");
  printer.arc_resolution = 0.1;
  for (const gcode::Control& target : gcode::controls()) {
    const Machine& usual = *find_machine(target.machine);
    EXPECT_EQ(target_on_machine(target, usual).get(), &target) << target.name;
  }
  // What they cut by is no setting of these machines.
  for (const char* name : {"marlin", "smoothieware", "reprapfirmware", "g2core", "linuxcnc"}) {
    const gcode::Control& target = *gcode::find_control(name);
    EXPECT_EQ(target_on_machine(target, router).get(), &target) << name;
    EXPECT_EQ(target_on_machine(target, printer).get(), &target) << name;
  }
}

TEST(OnlyControlOf, IsTheOneWhoseMachinesAreOfThisModel) {
  EXPECT_EQ(only_control_of(ControllerModel::kLinuxcnc), gcode::find_control("linuxcnc"));
  EXPECT_EQ(only_control_of(ControllerModel::kGrblhal), gcode::find_control("grblhal"));
  EXPECT_EQ(only_control_of(ControllerModel::kKlipper), gcode::find_control("klipper"));
  EXPECT_EQ(only_control_of(find_machine("router")->model), nullptr);
  EXPECT_EQ(only_control_of(find_machine("mill")->model), nullptr);
}

}  // namespace
}  // namespace batten::postproc
