// What a user is told of --seam smooth where it does nothing.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "batten_process.h"

namespace batten {
namespace {

class SeamOption : public testing::Test {
 protected:
  void SetUp() override {
    folder_.put("ring.nc", program("X0 Y0"));
    folder_.put("open.nc", program("X-20 Y0"));
  }
  // Three lines, the last of which ends there.
  static std::string program(const std::string& end) {
    return "G21 G17 G90 G94\nG0 X0 Y0\nG1 X20 Y0 F3000\nG1 X10 Y17\nG1 " + end + "\nM2\n";
  }
  ProcessResult smooth(const std::string& file, const std::string& more) {
    return folder_.batten("smooth " + file + " -o new.nc --force -t grbl --tolerance 0.05 " + more);
  }
  BattenFolder folder_;
};

TEST_F(SeamOption, IsNotedAtTheBeginOfAProgramWithoutAClosedRun) {
  expect_exit(smooth("open.nc", "--seam smooth"), 0,
              {"open.nc:1:1: note: seam-not-rounded: --seam smooth changes nothing: no run ends "
               "where it begins"});
}

TEST_F(SeamOption, IsNotedAtTheFirstClosedRunThatIsKept) {
  expect_exit(smooth("ring.nc", "--seam smooth --method guo"), 0,
              {"ring.nc:3:1: note: seam-not-rounded: --seam smooth changes nothing: found 1 closed "
               "run, the first here"});
}

TEST_F(SeamOption, IsNotNotedWhereItRoundsASeamOrIsNotAsked) {
  for (const char* options : {"--seam smooth --method ozcan --output arcs", "--seam corner", ""}) {
    const ProcessResult said = expect_exit(smooth("ring.nc", options), 0);
    EXPECT_EQ(said.err.find("seam-not-rounded"), std::string::npos) << said.err;
  }
}

TEST_F(SeamOption, StandsInTheReportWithWhatToDo) {
  const ProcessResult said = expect_exit(smooth("open.nc", "--seam smooth --json -"), 0);
  const auto report = nlohmann::json::parse(said.out);
  ASSERT_EQ(report["diagnostics"].size(), 1U);
  EXPECT_EQ(report["diagnostics"][0]["id"], "seam-not-rounded");
  EXPECT_FALSE(report["diagnostics"][0]["advice"].get<std::string>().empty());
}

TEST_F(SeamOption, IsRefusedWithAMethodThatLeavesTheSeam) {
  for (const char* method : {"guo-literal", "none"}) {
    expect_exit(smooth("ring.nc", std::string("--seam smooth --method ") + method), 1,
                {std::string("--seam: --method ") + method + " rounds no seam"});
  }
}

}  // namespace
}  // namespace batten
