// The comment that a program was smoothed: written once, found again, whatever stands around it.
#include "postproc/stream/provenance.h"

#include <gtest/gtest.h>

#include "gcode/controls/built_in.h"
#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

bool says_so(const std::string& text) { return was_smoothed(tests::Interpreted(text).program); }

TEST(Provenance, IsFoundAgainForEveryTarget) {
  for (const gcode::Control& target : gcode::controls()) {
    const std::string comment = provenance_comment(target, 0.01);
    if (comment.empty()) {
      EXPECT_EQ(target.name, "codesys") << "the only one of which no comment is known";
      continue;
    }
    EXPECT_TRUE(says_so("G21\n" + comment + "\nG1 X1\n")) << comment;
    EXPECT_TRUE(says_so("G21\r\n" + comment + "\r\nG1 X1\r\n")) << comment;
    EXPECT_LE(line_length(target, comment), target.max_line_length);
  }
}

TEST(Provenance, TellsTheTolerance) {
  const gcode::Control& target = *gcode::find_control("linuxcnc");
  EXPECT_EQ(provenance_comment(target, 0.01), "(Batten: smoothed within 0.01 mm)");
  EXPECT_EQ(provenance_comment(target, 0.0127), "(Batten: smoothed within 0.0127 mm)");
  EXPECT_EQ(provenance_comment(target, 1), "(Batten: smoothed within 1 mm)");
}

struct CommentCase {
  std::string name;
  std::string text;
  bool smoothed;
};

void PrintTo(const CommentCase& test, std::ostream* out) { *out << test.name; }

class IsSmoothed : public testing::TestWithParam<CommentCase> {};

TEST_P(IsSmoothed, WhenACommentSaysSo) { EXPECT_EQ(says_so(GetParam().text), GetParam().smoothed); }

INSTANTIATE_TEST_SUITE_P(
    Provenance, IsSmoothed,
    testing::Values(CommentCase{"NoComment", "G21\nG1 X1\n", false},
                    CommentCase{"OtherComment", "(made by Batten)\nG21\n", false},
                    CommentCase{"LastLine", "G21\nM2\n(Batten: smoothed within 0.01 mm)", true},
                    CommentCase{"BesideABlock", "G21 (Batten: smoothed within 0.01 mm)\n", true},
                    CommentCase{"AfterASemicolon", "; Batten: smoothed within 0.05 mm\nG21\n",
                                true},
                    CommentCase{"InsideALongerComment",
                                "(part 7, Batten: smoothed within 0.01 mm, checked)\nG21\n", true}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace batten::postproc
