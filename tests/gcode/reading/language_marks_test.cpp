#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "gcode/reading/source_kind.h"
#include "gcode/text/line_cursor.h"

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

// Every line asked for itself.
std::vector<LanguageMark> marks_line_by_line(const std::string& text) {
  std::vector<LanguageMark> marks;
  LineCursor lines(text);
  while (const auto line = lines.next()) {
    const std::size_t begin =
        std::min<std::size_t>(text.find_first_not_of(" \t", line->begin), line->text_end);
    const auto found =
        language_of_line(std::string_view(text).substr(begin, line->text_end - begin));
    const bool known = !found || std::ranges::any_of(marks, [&](const LanguageMark& each) {
      return each.language == found->language;
    });
    if (!known) {
      marks.push_back(
          {found->language, found->evidence, {static_cast<std::uint32_t>(begin), line->text_end}});
    }
  }
  return marks;
}

// Stretches without a letter of a mark are passed over: that loses none and finds no other.
TEST(LanguageMarks, AreThoseOfEachLineForItself) {
  std::vector<std::string> lines;
  for (const char* line : {"X1.234 Y-5.678",
                           "X1Y2Z3",
                           "N10 G1 X5",
                           "",
                           "D1 B2",
                           "(a comment; B)",
                           "; text",
                           "%",
                           "  ",
                           "G1 X1 ; DEF REAL",
                           "0 BEGIN PGM A MM",
                           "  def REAL X",
                           "N7 BEGIN PGM B MM",
                           "%_N_A_MPF",
                           ";$PATH=/_N_A",
                           "BEGIN",
                           "X1 B5 D7",
                           "12BEGIN PGM",
                           "N5DEF INT A",
                           "DEFREAL"}) {
    lines.emplace_back(line);
  }
  const std::vector<std::string> ends = {"\n", "\n", "\r\n", "\r"};
  std::size_t found = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    std::string text;
    for (int i = 0; i < 40; ++i) {
      // Plain lines as a rule, so that whole stretches have none.
      const std::size_t most = random() % 4 == 0 ? lines.size() : 4;
      text += lines[random() % most] + ends[random() % ends.size()];
    }
    SCOPED_TRACE(text);
    const auto expected = marks_line_by_line(text);
    const auto marks = marks_in(text);
    ASSERT_EQ(marks.size(), expected.size());
    for (std::size_t i = 0; i < marks.size(); ++i) {
      EXPECT_EQ(marks[i].language, expected[i].language);
      EXPECT_EQ(marks[i].evidence, expected[i].evidence);
      EXPECT_EQ(marks[i].where.begin, expected[i].where.begin);
      EXPECT_EQ(marks[i].where.end, expected[i].where.end);
    }
    found += marks.size();
  }
  EXPECT_GT(found, 2000U);
}

}  // namespace
}  // namespace batten::gcode
