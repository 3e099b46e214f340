// Numbers with and without a decimal point, where nobody says for which control they are.
#include "postproc/proof/point_spelling.h"

#include <gtest/gtest.h>

#include <string>

namespace batten::postproc {
namespace {

struct SpellingCase {
  std::string name;
  std::string before;
  std::string after;
  std::uint32_t line;  // of what is other; 0: nothing is
};

void PrintTo(const SpellingCase& test, std::ostream* out) { *out << test.name; }

class PointSpelling : public testing::TestWithParam<SpellingCase> {};

TEST_P(PointSpelling, IsOtherWhereSomeControlsReadAnotherLength) {
  const gcode::SourceText before("old.nc", GetParam().before);
  const gcode::SourceText after("new.nc", GetParam().after);
  const auto violation = other_point_spelling(before, after);
  ASSERT_EQ(violation.has_value(), GetParam().line > 0) << (violation ? violation->message : "");
  if (!violation) return;
  EXPECT_EQ(violation->id, "point-spelling");
  EXPECT_EQ(violation->new_line, GetParam().line);
  EXPECT_NE(violation->message.find("--target"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Lengths, PointSpelling,
    testing::Values(
        SpellingCase{"LostPoint", "G1 X10.\nX20.\n", "G1 X10.\nX20\n", 2},
        SpellingCase{"OnlyLength", "G1 X10. F100.\n", "G1 X10 F100.\n", 1},
        SpellingCase{"AnotherNumberWithoutPoint", "G1 X10.\nX20.\n", "G1 X10.\nX7\nX20.\n", 2},
        SpellingCase{"OneOfBothSpellings", "G1 X10.\nY10\n", "G1 X10\nY10\n", 1},
        SpellingCase{"CentreOfAnArc", "G2 X10. I5.\n", "G2 X10. I5\n", 1},
        SpellingCase{"AddedPoint", "G1 X10000\nX20000\n", "G1 X10000.\nX20000\n", 1},
        SpellingCase{"SameSpelling", "G1 X10.\nX20.\n", "G1 X10.\nX15.5\nX20.\n", 0},
        SpellingCase{"WholeNumbersWithoutPoint", "G1 X10 Y5.25\nX20\n", "G1 X10 Y5.25\nX7\n", 0},
        SpellingCase{"FixedDecimalsDropped", "G1 X10.000 Y5.250\n", "G1 X10 Y5.25\n", 0},
        SpellingCase{"CurveOfWholeNumbers", "G1 X10\nX20\n", "G1 X10.25\nX20\n", 0},
        SpellingCase{"Zero", "G1 X10. Y0.\n", "G1 X10. Y0\n", 0},
        SpellingCase{"Feed", "G1 X10. F100.\n", "G1 X10. F100\n", 1},
        SpellingCase{"FeedWithNewPoint", "G1 X10. F100\n", "G1 X10. F100.\n", 1},
        SpellingCase{"FeedsWithoutPoint", "G1 X10. F100\n", "G1 X10. F50\n", 0},
        SpellingCase{"FixedDecimalsOfFeed", "G1 X10. F100.00\n", "G1 X10. F100\n", 0},
        SpellingCase{"Count", "G1 X10.\nG81 X5. L3\n", "G1 X10.\nG81 X5. L3 P1\n", 0}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace batten::postproc
