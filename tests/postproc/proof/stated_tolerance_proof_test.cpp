// The proof checks each part by the tolerance that the old program says for it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "postproc/proof/verification.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

const std::string kStart = "G21 G90 G17\nG0 X0 Y0 Z0\n";
const std::string kFinish = "G0 Z5\nM2\n";

// A line along X, of which X20 may be off.
std::string line_program(const std::string& comment, double off) {
  return kStart + comment + fmt::format("G1 X10 Y0 F1000\nX20 Y{:.4f}\nX30 Y0\n", off) + kFinish;
}

bool is_proved_within(const std::string& comment, double off, double tolerance_mm) {
  return verdict(line_program(comment, 0), line_program(comment, off), tolerance_mm).proved();
}

TEST(StatedToleranceProof, TakesTheLesserOfBoth) {
  EXPECT_TRUE(is_proved_within("", 0.008, 0.01));
  EXPECT_FALSE(is_proved_within("(TOLERANCE 0.005)\n", 0.008, 0.01));
  EXPECT_TRUE(is_proved_within("(TOLERANCE 0.005)\n", 0.004, 0.01));
  EXPECT_TRUE(is_proved_within("(TOLERANCE 0.02)\n", 0.008, 0.01));
  EXPECT_FALSE(is_proved_within("(TOLERANCE 0.02)\n", 0.012, 0.01));
  EXPECT_TRUE(is_proved_within("(TOLERANCE +/-0.005)\n", 0.008, 0.01));  // uncertain: none
}

TEST(StatedToleranceProof, NamesItInTheViolationAndInTheSection) {
  const std::string comment = "(TOLERANCE 0.005)\n";
  const Verification broken = verdict(line_program(comment, 0), line_program(comment, 0.008), 0.01);
  ASSERT_EQ(broken.violations.size(), 1U);
  EXPECT_EQ(broken.violations[0].id, "distance");
  EXPECT_NE(broken.violations[0].message.find("allowed 0.005 mm"), std::string::npos)
      << broken.violations[0].message;
  const Verification kept = verdict(line_program(comment, 0), line_program(comment, 0.004), 0.01);
  ASSERT_EQ(kept.sections.size(), 1U);
  EXPECT_EQ(kept.sections[0].tolerance_mm, 0.005);
}

// What the new program says is not believed.
TEST(StatedToleranceProof, IsThatOfTheOldProgram) {
  EXPECT_FALSE(verdict(line_program("(TOLERANCE 0.005)\n", 0),
                       line_program("(TOLERANCE 0.05)\n", 0.008), 0.01)
                   .proved());
  EXPECT_FALSE(
      verdict(line_program("(TOLERANCE 0.005)\n", 0), line_program("", 0.008), 0.01).proved());
  EXPECT_TRUE(
      verdict(line_program("", 0), line_program("(TOLERANCE 0.005)\n", 0.008), 0.01).proved());
}

// A feed along which it changes at X20. X10 and X30 may be off.
std::string two_parts(const std::string& first, double off_first, const std::string& second,
                      double off_second, const std::string& at_end = "") {
  return kStart + first + fmt::format("G1 X10 Y{:.4f} F1000\nX20 Y0\n", off_first) + second +
         fmt::format("X30 Y{:.4f}\n", off_second) + at_end + "X40 Y0\n" + kFinish;
}

TEST(StatedToleranceProof, IsThatOfEachPartOfAFeed) {
  const std::string fine = "(TOLERANCE 0.005)\n";
  const std::string coarse = "(TOLERANCE 0.02)\n";
  const std::string before = two_parts(fine, 0, coarse, 0);
  const Verification both = verdict(before, two_parts(fine, 0.004, coarse, 0.015), 0.05);
  EXPECT_TRUE(both.proved());
  ASSERT_EQ(both.sections.size(), 2U);
  EXPECT_EQ(both.sections[0].tolerance_mm, 0.005);
  EXPECT_EQ(both.sections[1].tolerance_mm, 0.02);
  EXPECT_FALSE(verdict(before, two_parts(fine, 0.008, coarse, 0), 0.05).proved());
  EXPECT_FALSE(verdict(before, two_parts(fine, 0, coarse, 0.022), 0.05).proved());
  // Above the promised one there is no part.
  EXPECT_EQ(verdict(before, two_parts(fine, 0.001, coarse, 0.001), 0.004).sections.size(), 1U);
}

// Without the comments, or with others, nothing says where a part of the new path ends.
TEST(StatedToleranceProof, IsTheLeastWhereTheNewProgramSaysOthers) {
  const std::string fine = "(TOLERANCE 0.005)\n";
  const std::string coarse = "(TOLERANCE 0.02)\n";
  const std::string before = two_parts(fine, 0, coarse, 0);
  EXPECT_TRUE(verdict(before, two_parts("", 0.004, "", 0.004), 0.05).proved());
  EXPECT_FALSE(verdict(before, two_parts("", 0.004, "", 0.015), 0.05).proved());
  EXPECT_FALSE(verdict(before, two_parts(coarse, 0.004, fine, 0.015), 0.05).proved());
  // The comment stands elsewhere on the path.
  EXPECT_TRUE(verdict(before, two_parts(fine, 0.004, "", 0.004, coarse), 0.05).proved());
  const Verification found = verdict(before, two_parts(fine, 0.004, "", 0.015, coarse), 0.05);
  ASSERT_EQ(found.violations.size(), 1U);
  EXPECT_LT(found.violations[0].deviation_mm, 0.02);  // not the 10 mm to the comment
}

TEST(StatedToleranceProof, HoldsForMovesThatTheOldProgramDoesNotHave) {
  const auto text = [](const std::string& comment, const std::string& more) {
    return kStart + comment + "G1 X10 Y0 F1000\nM8\n" + more + "M9\nX20\n" + kFinish;
  };
  const std::string more = "Y0.008\nX10.001 Y0\n";
  EXPECT_TRUE(verdict(text("", ""), text("", more), 0.01).proved());
  const std::string fine = "(TOLERANCE 0.005)\n";
  EXPECT_FALSE(verdict(text(fine, ""), text(fine, more), 0.01).proved());
}

// The feed ends at another place of the same path, 0.008 mm away: within the tolerance of the user,
// not within that of the part.
TEST(StatedToleranceProof, HoldsForWhereAFeedBegins) {
  const auto text = [](const std::string& comment, const std::string& at) {
    return kStart + comment + "G1 X10 Y0 F1000\nX" + at + "\nX30 F500\n" + kFinish;
  };
  EXPECT_TRUE(verdict(text("", "20"), text("", "20.008"), 0.01).proved());
  const std::string fine = "(TOLERANCE 0.005)\n";
  EXPECT_FALSE(verdict(text(fine, "20"), text(fine, "20.008"), 0.01).proved());
}

// A rapid starts where the cut before it has ended, and a comment between them is for what follows.
TEST(StatedToleranceProof, HoldsForRapidsThatDoNotNameAnAxis) {
  const auto text = [](const std::string& comment, const std::string& y) {
    return kStart + "G1 X10 Y" + y + " F1000\n" + comment + "G0 Z5\nG0 X0 Y0\nM2\n";
  };
  EXPECT_TRUE(verdict(text("", "0"), text("", "0.008"), 0.01).proved());
  const std::string fine = "(TOLERANCE 0.005)\n";
  EXPECT_FALSE(verdict(text(fine, "0"), text(fine, "0.008"), 0.01).proved());
}

// A new path that crosses itself over two parts is found as in one: 0.008 mm beside each other.
TEST(StatedToleranceProof, FindsCrossingsBetweenParts) {
  const auto text = [](const std::string& comment, double y) {
    return kStart + "(TOLERANCE 0.009)\nG1 X10 Y0 F1000\nX20 Y0\nX20 Y5\nX15 Y5\n" + comment +
           fmt::format("X15 Y{:.4f}\nX10 Y{:.4f}\nX10 Y5\n", y, y) + kFinish;
  };
  for (const std::string comment : {"", "(TOLERANCE 0.008)\n"}) {
    const Verification found = verdict(text(comment, 0.004), text(comment, -0.002), 0.05);
    ASSERT_FALSE(found.proved());
    EXPECT_EQ(found.violations[0].id, "crosses-itself") << comment;
  }
}

}  // namespace
}  // namespace batten::postproc
