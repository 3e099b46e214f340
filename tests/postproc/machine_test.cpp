#include "postproc/machine/machine.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace batten::postproc {
namespace {

TEST(BuiltInMachines, AreFoundByTheirNames) {
  ASSERT_FALSE(built_in_machines().empty());
  for (const Machine& m : built_in_machines()) {
    SCOPED_TRACE(m.name);
    EXPECT_EQ(find_machine(m.name), &m);
    EXPECT_FALSE(m.description.empty());
  }
}

TEST(BuiltInMachines, HaveDifferentNames) {
  std::set<std::string> names;
  for (const Machine& m : built_in_machines()) EXPECT_TRUE(names.insert(m.name).second) << m.name;
}

TEST(BuiltInMachines, CoverEveryModel) {
  std::set<ControllerModel> models;
  for (const Machine& m : built_in_machines()) models.insert(m.model);
  EXPECT_EQ(models.size(), 3u);
}

TEST(BuiltInMachines, HaveLimitsThatMove) {
  for (const Machine& m : built_in_machines()) {
    SCOPED_TRACE(m.name);
    EXPECT_GT(m.max_velocity, 0);
    EXPECT_GT(m.max_acceleration, 0);
    EXPECT_GE(m.rapid_velocity, m.max_velocity);
    EXPECT_GT(m.block_period, 0);
    EXPECT_GT(m.look_ahead, 0);
  }
}

TEST(FindMachine, KnowsNoOtherNames) {
  EXPECT_EQ(find_machine("LinuxCNC"), nullptr);
  EXPECT_EQ(find_machine(""), nullptr);
}

}  // namespace
}  // namespace batten::postproc
