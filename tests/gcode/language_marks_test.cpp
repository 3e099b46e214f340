#include "gcode/language_marks.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace batten::gcode {
namespace {

std::vector<LanguageMark> marks_in(std::string text) {
  return language_marks(SourceText("test.nc", std::move(text)));
}

TEST(LanguageMarks, AreTheFirstOfEachLanguage) {
  const auto marks =
      marks_in("G1 X1\n%_N_A_MPF\n;$PATH=/_N_MPF_DIR\n0 BEGIN PGM A MM\n%_N_B_SPF\n");
  ASSERT_EQ(marks.size(), 2U);
  EXPECT_EQ(marks[0].language, Language::kSiemens);
  EXPECT_EQ(marks[0].where.begin, 6U);
  EXPECT_EQ(marks[1].language, Language::kKlartext);
}

TEST(LanguageMarks, AreNoneInWordsOfTheRs274Family) {
  EXPECT_TRUE(marks_in("%\nO1000\n(BEGIN PGM)\nN10 G1 X1 ; DEF REAL\nBEGIN\n").empty());
}

// Long texts are looked at part by part: about the ends of parts, and with lines longer than one.
TEST(LanguageMarks, AreFoundWhereverTheyStand) {
  const std::string mark = "12 BEGIN PGM PART MM\n";
  constexpr std::size_t kPart = std::size_t{1} << 23;
  for (const std::size_t before : {kPart - 24, kPart - 12, kPart - 3, kPart, 2 * kPart + 3}) {
    for (const char* line : {"X1\n", "X1\r\n"}) {
      SCOPED_TRACE(testing::Message() << before << " bytes before it");
      std::string text;
      while (text.size() < before) text += line;
      const std::size_t begin = text.size();
      text += mark + "L X+1\n";
      const auto marks = marks_in(text);
      ASSERT_EQ(marks.size(), 1U);
      EXPECT_EQ(marks[0].where.begin, begin);
      EXPECT_EQ(marks[0].where.end, begin + mark.size() - 1);
    }
  }
  const auto marks = marks_in(std::string(2 * kPart, 'X') + "\n" + mark);
  ASSERT_EQ(marks.size(), 1U);
  EXPECT_EQ(marks[0].where.begin, 2 * kPart + 1);
}

}  // namespace
}  // namespace batten::gcode
