// Full circles that a control may lose, as a user is told of them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "batten_process.h"

namespace batten {
namespace {

class MisreadArcs : public testing::Test {
 protected:
  void SetUp() override {
    folder_.put("rings.nc",
                "G21 G17 G90 G94\nG0 X100.1 Y50.3\nG2 I1 J0 F100\nG3 I30 J0\nG2 I0.5 J0\nM2\n");
  }
  BattenFolder folder_;
};

TEST_F(MisreadArcs, AreNotedAndCopied) {
  expect_exit(folder_.batten("smooth rings.nc -o new.nc --target grbl --tolerance 0.01"), 0,
              {"rings.nc:3:1: note: arc-misread: grbl may take this arc"});
  EXPECT_EQ(folder_.text_of("new.nc"), folder_.text_of("rings.nc"));
  const ProcessResult other =
      folder_.batten("smooth rings.nc -o new.nc --target grblhal --tolerance 0.01 --force");
  EXPECT_EQ(other.err.find("arc-misread"), std::string::npos) << other.err;
}

TEST_F(MisreadArcs, StandInTheReportWithTheirLineAndWhatToDo) {
  for (const char* command : {"smooth rings.nc -o new.nc --target grbl --tolerance 0.01 --json -",
                              "inspect rings.nc --target grbl --json -"}) {
    SCOPED_TRACE(command);
    const ProcessResult said = expect_exit(folder_.batten(command), 0);
    const auto report = nlohmann::json::parse(said.out);
    std::size_t found = 0;
    for (const auto& each : report["diagnostics"]) {
      if (each["id"] != "arc-misread") continue;
      ++found;
      EXPECT_EQ(each["severity"], "note");
      EXPECT_EQ(each["line"], 3);
      EXPECT_NE(each["message"].get<std::string>().find("the same in line 5"), std::string::npos)
          << each;
      EXPECT_FALSE(each["advice"].get<std::string>().empty());
    }
    EXPECT_EQ(found, 1U);
  }
}

TEST_F(MisreadArcs, CanBeExplained) {
  const ProcessResult said = expect_exit(folder_.batten("explain arc-misread"), 0);
  EXPECT_NE(said.out.find("two half circles"), std::string::npos) << said.out;
}

}  // namespace
}  // namespace batten
