#include "postproc/machine/machine.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "gcode/control/control.h"
#include "gcode/controls/built_in.h"
#include "postproc/machine/machine_fields.h"
#include "tests/support/machine_limits.h"

namespace batten::postproc {
namespace {

TEST(BuiltInMachines, AreSoundAndCoverEveryModel) {
  std::set<ControllerModel> models;
  std::set<std::string> names;
  for (const Machine& m : built_in_machines()) {
    SCOPED_TRACE(m.name);
    models.insert(m.model);
    EXPECT_TRUE(names.insert(m.name).second);
    EXPECT_EQ(find_machine(m.name), &m);
    EXPECT_FALSE(m.description.empty());
    EXPECT_FALSE(m.source.empty());
    for (const MachineProblem& problem : problems_of(m)) {
      ADD_FAILURE() << problem.key << ": " << problem.value << ", expected " << problem.expected;
    }
    EXPECT_GE(m.rapid_velocity(), m.max_velocity());
  }
  EXPECT_EQ(models.size(), kControllerModels.size());
  EXPECT_EQ(find_machine("LinuxCNC"), nullptr);
  EXPECT_EQ(find_machine(""), nullptr);
}

TEST(BuiltInMachines, RunTheTargetsThatNameThem) {
  for (const gcode::Control& target : gcode::controls()) {
    EXPECT_NE(find_machine(target.machine), nullptr) << target.name;
  }
}

// defaults.h of grbl 1.1: 500 mm/min and 10 mm/s^2 on every axis, $11 = 0.01, $12 = 0.002.
TEST(BuiltInMachines, HaveGrblAsItComes) {
  const Machine& m = *find_machine("grbl");
  EXPECT_EQ(m.model, ControllerModel::kGrbl);
  EXPECT_DOUBLE_EQ(m.max_velocity(), 500.0 / 60);
  EXPECT_DOUBLE_EQ(m.rapid_velocity(), 500.0 / 60);
  EXPECT_DOUBLE_EQ(m.max_acceleration(), 10);
  EXPECT_DOUBLE_EQ(m.junction_deviation, 0.01);
  EXPECT_DOUBLE_EQ(m.arc_tolerance, 0.002);
  EXPECT_EQ(m.look_ahead, 15);
}

// LinuxCNC's sim/qtdragon/qtdragon_xyz/qtdragon_metric.ini: MAX_VELOCITY 60, of Z 40,
// MAX_ACCELERATION 500, MAX_LINEAR_VELOCITY 60, startup code G64P0.0127.
TEST(BuiltInMachines, HaveLinuxcncAsItsSampleConfigurationIs) {
  const Machine& m = *find_machine("linuxcnc");
  const AxisLimits limits{60, 500, Machine::kNone, 60};
  EXPECT_EQ(m.axis(Axis::kX), limits);
  EXPECT_EQ(m.axis(Axis::kY), limits);
  EXPECT_EQ(m.axis(Axis::kZ), (AxisLimits{40, 500, Machine::kNone, 40}));
  EXPECT_EQ(m.path_feed, 60);
  EXPECT_EQ(m.blend_tolerance, 0.0127);
  EXPECT_EQ(m.naive_cam_tolerance, 0.0127);
}

TEST(BuiltInMachines, HaveWhatTheirDescriptionsSay) {
  const Machine& router = *find_machine("router");
  EXPECT_EQ(router.model, ControllerModel::kGrbl);
  EXPECT_DOUBLE_EQ(router.stream_rate, 115200.0 / 10);  // a start bit, eight of data and a stop bit
  EXPECT_EQ(find_machine("linuxcnc-fast")->max_velocity(), 400);
  EXPECT_EQ(find_machine("linuxcnc-fast")->max_acceleration(), 4000);
  EXPECT_EQ(find_machine("old-mill")->look_ahead, 20);
  EXPECT_DOUBLE_EQ(find_machine("old-mill")->block_period, 1.0 / 1000);
  EXPECT_TRUE(std::isfinite(find_machine("high-speed")->max_jerk()));
  EXPECT_TRUE(std::isinf(find_machine("mill")->max_jerk()));
}

TEST(Machine, HasTheLeastOfXyzForRulesThatKnowOneLimit) {
  Machine m;
  m.axis(Axis::kX) = {300, 2000, 50000, 500};
  m.axis(Axis::kY) = {200, 3000, 40000, 600};
  m.axis(Axis::kZ) = {250, 4000, Machine::kNone, 400};
  m.axis(Axis::kA) = {1, 1, 1, 1};  // degrees, which are no millimetres
  EXPECT_EQ(m.max_velocity(), 200);
  EXPECT_EQ(m.max_acceleration(), 2000);
  EXPECT_EQ(m.max_jerk(), 40000);
  EXPECT_EQ(m.rapid_velocity(), 400);
  set_max_velocity(m, 77);
  EXPECT_EQ(m.axis(Axis::kX).velocity, 77);
  EXPECT_EQ(m.axis(Axis::kZ).velocity, 77);
  EXPECT_EQ(m.axis(Axis::kA).velocity, 1);
}

// What no model can work with is asked for in machine_files_test.cpp.
TEST(Machine, NeedsNoJunctionDeviationWithoutGrbl) {
  Machine m = *find_machine("mill");
  m.junction_deviation = 0;
  EXPECT_TRUE(problems_of(m).empty());
}

// --- units ---------------------------------------------------------------------------------------

struct QuantityCase {
  const char* text;
  Quantity quantity;
  double value;
};

TEST(ReadQuantity, KnowsTheUnits) {
  for (const QuantityCase& c : {QuantityCase{"5000 mm/min", Quantity::kVelocity, 5000.0 / 60},
                                QuantityCase{"83.5mm/s", Quantity::kVelocity, 83.5},
                                QuantityCase{"20 m/min", Quantity::kVelocity, 20000.0 / 60},
                                QuantityCase{"300 in/min", Quantity::kVelocity, 300 * 25.4 / 60},
                                QuantityCase{"300 ipm", Quantity::kVelocity, 127},
                                QuantityCase{"0.5 g", Quantity::kAcceleration, 4903.325},
                                QuantityCase{"2 m/s2", Quantity::kAcceleration, 2000},
                                QuantityCase{"2 m/s^2", Quantity::kAcceleration, 2000},
                                QuantityCase{"50 m/s3", Quantity::kJerk, 50000},
                                QuantityCase{"25 rpm", Quantity::kAngularVelocity, 150},
                                QuantityCase{"180 deg/min", Quantity::kAngularVelocity, 3},
                                QuantityCase{"0.5 ms", Quantity::kTime, 0.0005},
                                QuantityCase{"2 um", Quantity::kLength, 0.002},
                                QuantityCase{"0.0005 in", Quantity::kLength, 0.0127},
                                QuantityCase{"1000 blocks/s", Quantity::kBlockRate, 1000},
                                QuantityCase{"9600 baud", Quantity::kByteRate, 960}}) {
    const auto value = read_quantity(c.text, c.quantity);
    ASSERT_TRUE(value.has_value()) << c.text;
    EXPECT_NEAR(*value, c.value, 1e-12 * std::abs(c.value)) << c.text;
  }
}

TEST(ReadQuantity, NeedsAUnitOfTheKind) {
  for (const char* text : {"", "mm/s", "5", "5 mm", "5 mm/s2", "5 MM/S", "inf mm/s", "5 mm/s x"}) {
    EXPECT_FALSE(read_quantity(text, Quantity::kVelocity).has_value()) << text;
  }
}

}  // namespace
}  // namespace batten::postproc
