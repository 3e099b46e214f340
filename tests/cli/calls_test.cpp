// Programs that call others, as a user meets them.
#include <gtest/gtest.h>

#include "batten_process.h"
#include "tests/support/wavy_programs.h"

namespace batten {
namespace {

// A wave behind a call.
class Calls : public testing::Test {
 protected:
  void SetUp() override {
    folder_.put("part.nc", "G21 G90 G17\nS12000 M3\nM98 P1000\nG0 X0. Y0. Z5.\nG1 Z-1. F300.\n" +
                               postproc::joined(postproc::wave_lines({}), "\n") + "G0 Z5.\nM30\n");
  }
  BattenFolder folder_;
};

TEST_F(Calls, LeaveNothingKnownUnlessTheUserKnowsBetter) {
  const std::string smooth = "smooth part.nc --target haas --tolerance 0.01 -o ";
  const ProcessResult kept = expect_exit(
      folder_.batten(smooth + "kept.nc"), 0,
      {"for haas: nothing to smooth: 100.0 % of the cutting moves, since line 3 'M98 P1000'"});
  EXPECT_EQ(folder_.text_of("kept.nc"), folder_.text_of("part.nc"));

  expect_exit(folder_.batten(smooth + "new.nc --allow subprogram"), 0, {"1 rewritten"});
}

TEST_F(Calls, AreReadByVerifyAsTheUserSays) {
  ASSERT_EQ(folder_
                .batten("smooth part.nc --target haas --tolerance 0.01 --allow subprogram -o "
                        "new.nc")
                .exit_code,
            0);
  const std::string verify = "verify part.nc new.nc --tolerance 0.01";
  EXPECT_EQ(folder_.batten(verify).exit_code, 3);
  expect_exit(folder_.batten(verify + " --allow subprogram"), 0);
  std::string damaged = folder_.text_of("new.nc");
  damaged.replace(damaged.find("G1 Z-1."), 7, "G1 Z-2.");
  folder_.put("new.nc", damaged);
  EXPECT_EQ(folder_.batten(verify + " --allow subprogram").exit_code, 3);
  EXPECT_EQ(folder_.batten(verify + " --allow cutter-compensation").exit_code, 1);
}

TEST_F(Calls, ShowInInspectWhatTheyLeaveKnown) {
  EXPECT_TRUE(contains(folder_.batten("inspect part.nc").out, "state-unknown"));
  EXPECT_FALSE(contains(folder_.batten("inspect part.nc --allow subprogram").out, "state-unknown"));
}

}  // namespace
}  // namespace batten
