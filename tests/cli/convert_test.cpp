// Programs of one language for controls of another, as a user meets them.
#include <gtest/gtest.h>

#include "batten_process.h"

namespace batten {
namespace {

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
  expect_exit(folder_.batten("smooth 1234.h --target fanuc -o new.nc"), 2,
              {"1234.h:1:1: error: foreign-language", "--convert says it there"});
  EXPECT_FALSE(folder_.has("new.nc"));
}

TEST_F(Conversions, FromKlartextAreWrittenAndProvedAgain) {
  expect_exit(folder_.batten("smooth 1234.h --target fanuc --convert -o new.nc"), 0);
  EXPECT_EQ(folder_.text_of("new.nc"),
            "%\nO1234\nG21 G17 G40 G90 G94\nT5 M6\nG43 H5\nS3000 M3\nG0 X0. Y0.\nZ5.\n"
            "G1 Z-1. F200.\nX10. F500.\nG2 X20. I5.\nG0 Z50.\nM5\nM30\n%\n");
  expect_exit(folder_.batten("verify 1234.h new.nc --target fanuc"), 0);
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

TEST_F(Conversions, OfPlainWordsForKlartextAreAskedFor) {
  folder_.put("plain.nc", "%\nO1\n(part)\nN10 G21 G90\nN20 G0 X0 Y0 Z5\nG1 X5 F100\nM30\n%\n");
  expect_exit(folder_.batten("smooth plain.nc --target heidenhain -o new.h"), 2,
              {"plain.nc:4:1: error: foreign-language: found N10 G21 G90"});
  EXPECT_FALSE(folder_.has("new.h"));
  EXPECT_EQ(folder_.batten("smooth plain.nc --target heidenhain --convert -o new.h").exit_code, 0);
  const ProcessResult told = folder_.batten("explain foreign-language");
  EXPECT_TRUE(contains(told.out, "--convert")) << told.out;
}

// What P means says --source alone, to smooth and to verify.
TEST_F(Conversions, OfDwellsAskForTheirSource) {
  folder_.put("plain.nc", "G21 G90\nG0 X0 Y0 Z5\nG4 P0.5\nG1 X5 F100\nM30\n");
  expect_exit(folder_.batten("smooth plain.nc --target siemens --convert"), 2,
              {"--source ngc, grbl, fanuc or haas says which"});
  expect_exit(folder_.batten("smooth plain.nc --target siemens --convert --source ngc -o new.mpf"),
              0);
  EXPECT_TRUE(contains(folder_.text_of("new.mpf"), "\nG4 F0.5\n"));
  EXPECT_EQ(folder_.batten("verify plain.nc new.mpf --target siemens --source ngc").exit_code, 0);
  EXPECT_EQ(folder_.batten("verify plain.nc new.mpf --target siemens --source grbl").exit_code, 0);
  EXPECT_EQ(folder_.batten("verify plain.nc new.mpf --target siemens").exit_code, 3);
  EXPECT_EQ(folder_.batten("verify plain.nc new.mpf --target siemens --source fanuc").exit_code, 3);
}

TEST_F(Conversions, TellTheLineAndTheWordThatCannotBeSaid) {
  std::string text = kKlartextProgram;
  text.replace(text.find("4 L Z-1"), 7, "4 L Z-1 RL");
  folder_.put("part.h", text);
  expect_exit(folder_.batten("smooth part.h --target haas --convert -o new.nc"), 2,
              {"part.h:5:9: error: cannot-convert: RL moves beside the path"});
  EXPECT_FALSE(folder_.has("new.nc"));
}

}  // namespace
}  // namespace batten
