#include "postproc/proof/refused_arcs.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gcode/control/dialect.h"
#include "gcode/controls/built_in.h"
#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

constexpr const char* kBegin = "G21 G17 G90 G94\nG0 X0 Y0 Z0\nF100\n";

std::vector<Violation> breaches_of(const std::string& before, const std::string& after) {
  const tests::Interpreted old_read(kBegin + before);
  const tests::Interpreted new_read(kBegin + after);
  const ReadProgram a{&old_read.program, &old_read.read};
  const ReadProgram b{&new_read.program, &new_read.read};
  return refused_arcs(a, b, verify(a, b, 1.0).stretches, *gcode::find_dialect("linuxcnc"),
                      [](std::uint32_t, const Stretch& stretch) { return stretch.old_last_line; });
}

TEST(RefusedArcs, AreFoundInTheTextByTheTargetsLeastRadius) {
  const std::string line = "G1 X1\n";
  const auto found = breaches_of(line, "G1 X0.5\nG2 X0.5001 Y0.0001 I0.0001 J0\nG1 X1 Y0\n");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].id, "arc-refused");
  EXPECT_EQ(found[0].kind, ViolationKind::kTarget);
  EXPECT_EQ(found[0].old_line, 4U);
  EXPECT_EQ(found[0].new_line, 5U);
  EXPECT_EQ(breaches_of(line, "G1 X0.5\nG2 X0.6 Y0 I0.05 J0\nG1 X1\n").size(), 0U);
  EXPECT_EQ(breaches_of(line, "G1 X0.5\nG2 X0.5998 Y0 I0.0499 J0\nG1 X1\n").size(), 1U);
}

TEST(RefusedArcs, AreNoneThatTheProgramHadItself) {
  const std::string arc = "G2 X0.5001 Y0.0001 I0.0001 J0\n";
  EXPECT_EQ(breaches_of("G1 X0.5\n" + arc + "G1 X1 Y0\n",
                        "G1 X0.3 Y0.01\nX0.5 Y0\n" + arc + "G1 X0.8 Y0.01\nX1 Y0\n")
                .size(),
            0U);
}

}  // namespace
}  // namespace batten::postproc
