#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "gcode/controls/built_in.h"
#include "postproc/proof/verification.h"
#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

constexpr const char* kBegin = "G21 G17 G90 G94\nG0 X0 Y0 Z0\nF100\n";

std::vector<Violation> violations_of(const std::string& before, const std::string& after,
                                     const char* target = "linuxcnc") {
  const tests::Interpreted old_read(kBegin + before);
  const tests::Interpreted new_read(kBegin + after);
  const ReadProgram a{&old_read.program, &old_read.read};
  const ReadProgram b{&new_read.program, &new_read.read};
  const Promise promise(1.0, geometry::ToleranceKind::kPath, geometry::Side::kBoth,
                        gcode::find_control(target));
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

// A quarter of radius 5 is 7.85 mm: at `resolution` 1 seven chords, 0.0314 mm beside it.
class CutArcs : public testing::Test {
 protected:
  [[nodiscard]] std::vector<Violation> found(const std::string& before, const std::string& after,
                                             double tolerance, double resolution = 1) const {
    gcode::Control target = *gcode::find_control("klipper");
    target.chords.longest = resolution;
    const tests::Interpreted old_read(kBegin + before);
    const tests::Interpreted new_read(kBegin + after);
    return verify({&old_read.program, &old_read.read}, {&new_read.program, &new_read.read},
                  {tolerance, kind_, geometry::Side::kBoth, &target})
        .violations;
  }

  // The quarter in lines that leave it by 0.0015 mm, and what is cut before and behind it.
  static std::string with_lines(const std::string& behind) {
    std::string text = "G1 X20\n";
    for (int i = 1; i <= 32; ++i) {
      const double angle = i * std::numbers::pi / 64;
      text +=
          fmt::format("G1 X{:.6f} Y{:.6f}\n", 20 + 5 * std::sin(angle), 5 - 5 * std::cos(angle));
    }
    return text + behind;
  }
  static std::string with_arc(const std::string& behind) {
    return "G1 X20\nG3 X25 Y5 I0 J5\n" + behind;
  }

  geometry::ToleranceKind kind_ = geometry::ToleranceKind::kPath;
};

TEST_F(CutArcs, CountWithTheChordsThatTheTargetMakesOfThem) {
  for (const auto kind : {geometry::ToleranceKind::kPath, geometry::ToleranceKind::kBand}) {
    kind_ = kind;
    const std::string lines = with_lines("G1 Y20\n");
    const std::string arc = with_arc("G1 Y20\n");
    // As a path the chords of the target themselves are compared; else the errors add up.
    const bool as_run = kind == geometry::ToleranceKind::kPath;
    EXPECT_TRUE(found(lines, arc, as_run ? 0.0316 : 0.0335).empty());  // 0.0314 + 0.0015
    const auto broken = found(lines, arc, as_run ? 0.0312 : 0.032);
    ASSERT_EQ(broken.size(), 1U);
    EXPECT_EQ(broken[0].id, "arc-chords");
    EXPECT_EQ(broken[0].kind, ViolationKind::kTarget);
    EXPECT_EQ(broken[0].new_line, 5U);
    EXPECT_TRUE(found(lines, arc, 0.002, 0.1).empty());  // 0.00025 mm
    EXPECT_EQ(found(lines, arc, 0.0016, 0.1).size(), as_run ? 0U : 1U);
  }
}

// 7.85 mm are 78 chords or 79 where the resolution is but for a last digit a 79th of them.
TEST_F(CutArcs, CountByTheirErrorWhereTheirNumberIsNotCertain) {
  const std::string lines = with_lines("G1 Y20\n");
  const std::string arc = with_arc("G1 Y20\n");
  constexpr double kQuarter = 5 * std::numbers::pi / 2;
  EXPECT_TRUE(found(lines, arc, 0.0016, kQuarter / 78.5).empty());
  EXPECT_EQ(found(lines, arc, 0.0016, kQuarter / 79.00001).size(), 1U);
}

// What is far from the old path elsewhere has nothing to do with the chords of an arc here.
TEST_F(CutArcs, CountWhereTheyAre) {
  const std::string lines = with_lines("G1 Y20\nG1 X40\n");
  const std::string arc = with_arc("G1 Y20.033\nG1 X40 Y20\n");
  EXPECT_TRUE(found(lines, arc, 0.0335).empty());
}

// An arc that the program had itself is its own affair, also between moves that are new.
TEST_F(CutArcs, AreNoneThatTheProgramHadItself) {
  const std::string old_text = "G1 X10\n" + with_arc("G1 Y20\nG1 Y30\n");
  EXPECT_TRUE(found(old_text, "G1 X10 Y0.001\nG1 Y0\n" + with_arc("G1 Y30\n"), 0.01).empty());
  const auto other = found(old_text, "G1 X10\nG1 X20\nG3 X25.001 Y5 I0 J5\nG1 X25 Y30\n", 0.01);
  ASSERT_FALSE(other.empty());
  EXPECT_EQ(other[0].id, "arc-chords") << other[0].message;
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

// Siemens reads M30 (a) as a function with arguments.
TEST(RefusedComments, AreNewOnesInParenthesesWhereTheseAreNone) {
  const std::string line = "G1 X1\nM30\n";
  const std::string other = "G1 X1\nM30 (a)\n";
  for (const char* target : {"siemens", "klipper"}) {
    const auto found = violations_of(line, other, target);
    ASSERT_EQ(found.size(), 1U) << target;
    EXPECT_EQ(found[0].id, "comment-refused");
    EXPECT_EQ(found[0].kind, ViolationKind::kTarget);
    EXPECT_EQ(found[0].new_line, 5U);
    EXPECT_TRUE(violations_of(other, other, target).empty());
    EXPECT_TRUE(violations_of("(b)\n" + line, "(c)\n" + line, target).empty());
    EXPECT_TRUE(violations_of(line, "G1 X1\nM30 ; a\n", target).empty());
  }
  EXPECT_TRUE(violations_of(line, other, "linuxcnc").empty());
}

}  // namespace
}  // namespace batten::postproc
