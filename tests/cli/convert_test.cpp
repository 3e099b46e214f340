// Programs of one language for controls of another, as a user meets them.
#include <gtest/gtest.h>

#include <string>

#include "batten_process.h"

namespace batten {
namespace {

bool says(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

constexpr const char* kKlartextProgram =
    "0 BEGIN PGM 1234 MM\n1 TOOL CALL 5 Z S3000\n2 L X+0 Y+0 R0 FMAX M3\n3 L Z+5 FMAX\n"
    "4 L Z-1 F200\n5 L X+10 F500\n6 CC X+15 Y+0\n7 C X+20 Y+0 DR-\n8 L Z+50 FMAX M5\n9 M30\n"
    "10 END PGM 1234 MM\n";

class Conversions : public testing::Test {
 protected:
  void SetUp() override { folder_.put("1234.h", kKlartextProgram); }
  BattenFolder folder_;
};

TEST_F(Conversions, AreRefusedUnlessTheyAreAskedFor) {
  const ProcessResult refused = folder_.batten("smooth 1234.h --target fanuc -o new.nc");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_TRUE(says(refused.err, "1234.h:1:1: error: foreign-language")) << refused.err;
  EXPECT_TRUE(says(refused.err, "--convert says it there")) << refused.err;
  EXPECT_FALSE(folder_.has("new.nc"));
}

TEST_F(Conversions, FromKlartextAreWrittenAndProvedAgain) {
  const ProcessResult done = folder_.batten("smooth 1234.h --target fanuc --convert -o new.nc");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  EXPECT_EQ(folder_.text_of("new.nc"),
            "%\nO1234\nG21 G17 G40 G90 G94\nT5 M6\nG43 H5\nS3000 M3\nG0 X0. Y0.\nZ5.\n"
            "G1 Z-1. F200.\nX10. F500.\nG2 X20. I5.\nG0 Z50.\nM5\nM30\n%\n");
  const ProcessResult proved = folder_.batten("verify 1234.h new.nc --target fanuc");
  EXPECT_EQ(proved.exit_code, 0) << proved.err;
  std::string damaged = folder_.text_of("new.nc");
  damaged.replace(damaged.find("G2"), 2, "G3");
  folder_.put("new.nc", damaged);
  EXPECT_NE(folder_.batten("verify 1234.h new.nc --target fanuc").exit_code, 0);
}

TEST_F(Conversions, ThroughAllThreeLanguagesAreProvedAtEachStep) {
  ASSERT_EQ(folder_.batten("smooth 1234.h --target siemens --convert -o a.mpf").exit_code, 0);
  ASSERT_EQ(folder_.batten("verify 1234.h a.mpf --target siemens").exit_code, 0);
  ASSERT_EQ(folder_.batten("smooth a.mpf --target linuxcnc --convert -o b.ngc").exit_code, 0);
  ASSERT_EQ(folder_.batten("verify a.mpf b.ngc --target linuxcnc").exit_code, 0);
  ASSERT_EQ(folder_.batten("smooth b.ngc --target heidenhain --convert -o c.h").exit_code, 0);
  ASSERT_EQ(folder_.batten("verify b.ngc c.h --target heidenhain").exit_code, 0);
  EXPECT_EQ(folder_.text_of("c.h"),
            "0 BEGIN PGM B MM\n1 TOOL CALL 5 Z S3000\n2 M3\n3 L X+0 Y+0 R0 FMAX\n4 L Z+5 FMAX\n"
            "5 L Z-1 F200\n6 L X+10 F500\n7 CC X+15 Y+0\n8 C X+20 Y+0 DR-\n9 L Z+50 FMAX\n10 M5\n"
            "11 M30\n12 END PGM B MM\n");
}

TEST_F(Conversions, TellTheLineAndTheWordThatCannotBeSaid) {
  std::string text = kKlartextProgram;
  text.replace(text.find("4 L Z-1"), 7, "4 L Z-1 RL");
  folder_.put("part.h", text);
  const ProcessResult told = folder_.batten("smooth part.h --target haas --convert -o new.nc");
  EXPECT_EQ(told.exit_code, 2);
  EXPECT_TRUE(says(told.err, "part.h:5:9: error: cannot-convert: RL moves beside the path"))
      << told.err;
  EXPECT_FALSE(folder_.has("new.nc"));
}

}  // namespace
}  // namespace batten
