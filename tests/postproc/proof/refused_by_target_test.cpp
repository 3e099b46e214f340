#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gcode/controls/built_in.h"
#include "postproc/proof/verification.h"
#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

constexpr const char* kBegin = "G21 G17 G90 G94\nG0 X0 Y0 Z0\nF100\n";

std::vector<Violation> violations_of(const std::string& before, const std::string& after) {
  const tests::Interpreted old_read(kBegin + before);
  const tests::Interpreted new_read(kBegin + after);
  const ReadProgram a{&old_read.program, &old_read.read};
  const ReadProgram b{&new_read.program, &new_read.read};
  const Promise promise(1.0, geometry::ToleranceKind::kPath, geometry::Side::kBoth,
                        gcode::find_control("linuxcnc"));
  return verify(a, b, promise).violations;
}

TEST(RefusedArcs, AreFoundInTheTextByTheTargetsLeastRadius) {
  const std::string line = "G1 X1\n";
  const auto found = violations_of(line, "G1 X0.5\nG2 X0.5001 Y0.0001 I0.0001 J0\nG1 X1 Y0\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, "arc-refused");
  EXPECT_EQ(found[0].kind, ViolationKind::kTarget);
  EXPECT_EQ(found[0].old_line, 4U);
  EXPECT_EQ(found[0].new_line, 5U);
  EXPECT_EQ(violations_of(line, "G1 X0.5\nG2 X0.6 Y0 I0.05 J0\nG1 X1\n").size(), 0U);
  EXPECT_EQ(violations_of(line, "G1 X0.5\nG2 X0.5998 Y0 I0.0499 J0\nG1 X1\n").size(), 1U);
}

TEST(RefusedArcs, AreNoneThatTheProgramHadItself) {
  const std::string arc = "G2 X0.5001 Y0.0001 I0.0001 J0\n";
  EXPECT_EQ(violations_of("G1 X0.5\n" + arc + "G1 X1 Y0\n",
                          "G1 X0.3 Y0.01\nX0.5 Y0\n" + arc + "G1 X0.8 Y0.01\nX1 Y0\n")
                .size(),
            0U);
}

// LinuxCNC reads 252 bytes, comments and blanks among them.
TEST(RefusedLines, AreNewOnesThatAreTooLong) {
  const std::string line = "G1 X1\n";
  for (const std::string& longer :
       {"G1 X1 ;" + std::string(260, 'a') + "\n", "G1 X1\n(" + std::string(260, 'a') + ")\n",
        std::string(260, ' ') + "G1 X1\n"}) {
    const auto found = violations_of(line, longer);
    ASSERT_EQ(found.size(), 1U) << longer;
    EXPECT_EQ(found[0].id, "line-refused");
    EXPECT_EQ(found[0].kind, ViolationKind::kTarget);
    EXPECT_GE(found[0].new_line, 4U);
    EXPECT_TRUE(violations_of(longer, longer).empty());
    EXPECT_TRUE(violations_of(longer + "G1 X2\n", "G1 X1\nG1 X1.5\nG1 X2\n").empty());
  }
  EXPECT_TRUE(violations_of(line, "G1 X1 ;" + std::string(200, 'a') + "\n").empty());
}

}  // namespace
}  // namespace batten::postproc
