// --quiet, --log-level, NO_COLOR: how much is said, and in which colours.

#include <gtest/gtest.h>

#include "batten_process.h"
#include "tests/support/places.h"

namespace batten {
namespace {

// A run, and a block that gives a warning.
std::string doubtful_program() { return wave_program() + "G0 X1 X2\n"; }

class LogLevel : public testing::Test {
 protected:
  void SetUp() override { folder_.put("part.nc", doubtful_program()); }

  [[nodiscard]] ProcessResult smooth(const std::string& options) const {
    return folder_.batten("smooth part.nc --target linuxcnc --tolerance 0.01 --force " + options);
  }

  BattenFolder folder_;
};

TEST_F(LogLevel, OfInfoSaysWarningsAndTheSummary) {
  const std::string said = smooth("").err;
  EXPECT_TRUE(contains(said, "warning: word-repeated")) << said;
  EXPECT_TRUE(contains(said, "deviation")) << said;
  EXPECT_EQ(smooth("--log-level info").err, said);
}

TEST_F(LogLevel, OfWarningLeavesTheSummaryOut) {
  const std::string said = smooth("--log-level warning").err;
  EXPECT_TRUE(contains(said, "warning: word-repeated")) << said;
  EXPECT_FALSE(contains(said, "deviation")) << said;
}

TEST_F(LogLevel, QuietSaysNothingWhenAllIsWell) {
  EXPECT_EQ(expect_exit(smooth("--quiet"), 0).err, "");
  EXPECT_EQ(smooth("--log-level error").err, "");
  EXPECT_TRUE(folder_.has("part.smooth.nc"));
}

TEST_F(LogLevel, QuietSaysWhatStopsTheWork) {
  folder_.put("unknown.nc", "G1 X1 F100\n");
  expect_exit(folder_.batten("smooth unknown.nc --target linuxcnc --quiet"), 2, {"units-missing"});
}

TEST_F(LogLevel, QuietVerifySaysBreachesOnly) {
  folder_.put("other.nc", doubtful_program() + "M8\n");
  EXPECT_EQ(folder_.batten("verify part.nc part.nc --quiet").err, "");
  expect_exit(folder_.batten("verify part.nc other.nc --quiet"), 3, {"event-added"});
}

TEST_F(LogLevel, QuietAndMoreContradictEachOther) {
  EXPECT_EQ(smooth("--quiet --log-level info").exit_code, 1);
  EXPECT_EQ(smooth("--log-level loud").exit_code, 1);
}

// --- colour -------------------------------------------------------------------------------------

// What a terminal gets.
std::string on_a_terminal(const BattenFolder& folder, const std::string& environment) {
  return folder
      .shell("script -qec \"env " + environment +
             " '" BATTEN_BINARY
             "' smooth part.nc --target linuxcnc --force "
             "--progress off\" /dev/null")
      .out;
}

TEST_F(LogLevel, ColoursTheSeverityOnATerminalOnly) {
  if (folder_.shell("command -v script").exit_code != 0) GTEST_SKIP() << "no script(1)";
  const std::string shown = on_a_terminal(folder_, "-u NO_COLOR TERM=xterm");
  EXPECT_TRUE(contains(shown, "\x1b[1;33mwarning\x1b[0m: word-repeated")) << shown;
  EXPECT_FALSE(contains(smooth("").err, "\x1b"));
}

TEST_F(LogLevel, HasNoColourWhereTheUserWantsNone) {
  if (folder_.shell("command -v script").exit_code != 0) GTEST_SKIP() << "no script(1)";
  EXPECT_FALSE(contains(on_a_terminal(folder_, "NO_COLOR=1 TERM=xterm"), "\x1b"));
  EXPECT_FALSE(contains(on_a_terminal(folder_, "-u NO_COLOR TERM=dumb"), "\x1b"));
}

}  // namespace
}  // namespace batten
