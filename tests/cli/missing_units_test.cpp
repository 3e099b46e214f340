// Programs without G20 and G21, as a user meets them.
#include <gtest/gtest.h>

#include "batten_process.h"
#include "tests/support/wavy_programs.h"

namespace batten {
namespace {

std::string without_units(std::string program) {
  const std::size_t at = program.find("G21 ");
  return program.erase(at, 4);
}

class MissingUnits : public testing::Test {
 protected:
  void SetUp() override { folder_.put("my part.nc", without_units(wave_program())); }
  BattenFolder folder_;
};

// F2000 is no feed in inches.
TEST_F(MissingUnits, AreNeverGuessedButTheCommandIsGiven) {
  for (const char* command : {"smooth 'my part.nc' -o new.nc --target grbl --tolerance 0.01",
                              "explore 'my part.nc' --target grbl --tolerance 0.01",
                              "inspect 'my part.nc'", "time 'my part.nc' --machine grbl"}) {
    SCOPED_TRACE(command);
    const ProcessResult said = expect_exit(folder_.batten(command), 2,
                                           {"units-missing", "speak for mm", "feeds up to 2000"});
    EXPECT_FALSE(folder_.has("new.nc"));
    const std::size_t at = said.err.find("\n  batten ");
    ASSERT_NE(at, std::string::npos) << said.err;
    const std::string again = said.err.substr(at + 10, said.err.find('\n', at + 1) - at - 10);
    EXPECT_TRUE(again.ends_with(" --units mm")) << again;
    EXPECT_EQ(folder_.batten(again).exit_code, 0) << again;
    expect_exit(folder_.shell("rm -f new.nc"), 0);
  }
}

TEST_F(MissingUnits, AreAskedForWithBothCommandsWhereNothingSpeaks) {
  folder_.put("some.nc", "G0 X1 Y1\nG1 X5 Y5 F100\n");
  expect_exit(folder_.batten("smooth some.nc --target grbl"), 2,
              {"its numbers do not say which", "--units mm\n", "--units inch\n"});
}

TEST_F(MissingUnits, AreToldOnceByABatch) {
  expect_exit(folder_.shell("mkdir in && for i in 1 2 3 4 5; do cp 'my part.nc' in/$i.nc; done"),
              0);
  folder_.put("in/inch.nc", "(INCH)\nG0 X1.5 Y1.5\nG1 X2.25 F30.\n");
  const ProcessResult said =
      expect_exit(folder_.batten("batch in out --target grbl --tolerance 0.01"), 2,
                  {"6 programs without G20 or G21", "the numbers speak of 5 for mm, of 1 for inch",
                   "--units mm\n"});
  EXPECT_FALSE(contains(said.err, "1.nc:")) << said.err;
  expect_exit(folder_.shell("rm in/inch.nc"), 0);
  const ProcessResult of_one = folder_.batten("batch in out --target grbl --tolerance 0.01");
  EXPECT_FALSE(contains(of_one.err, "--units inch")) << of_one.err;
}

}  // namespace
}  // namespace batten
