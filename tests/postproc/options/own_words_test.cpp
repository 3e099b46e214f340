#include "postproc/options/own_words.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace batten::postproc {
namespace {

std::vector<std::string> problems_with(const std::vector<std::string>& texts) {
  OwnWordList list;
  std::vector<std::string> problems;
  for (const std::string& text : texts) list.add(text, problems);
  return problems;
}

TEST(OwnWordList, TakesEachFormByItsName) {
  OwnWordList list;
  std::vector<std::string> problems;
  for (const char* text :
       {"m0501=keeps state", "G05.4 = Ends  A Run", "\"G65 p9810\" = \"moves; position unknown\"",
        "M98P09001 = keeps state, returns", "o <Probe> call = keeps state", "o100 call = moves",
        "G51 = position unknown", "G52 = ends a run, position unknown", "L054 = returns", "call pgm probe.h = keeps state", "CLAMP_1 = keeps state"}) {
    list.add(text, problems);
  }
  EXPECT_TRUE(problems.empty()) << problems.front();
  const auto words = list.words();
  ASSERT_NE(words, nullptr);
  for (const char* name : {"M501", "G5.4", "G51", "G52", "G65 P9810", "M98 P9001", "O<PROBE> CALL", "O100 CALL",
                           "L054", "CALL PGM PROBE", "CLAMP_1"}) {
    EXPECT_NE(words->find(name), nullptr) << name;
  }
  EXPECT_TRUE(words->find("M98 P9001")->effect.returns);
  EXPECT_FALSE(words->find("G65 P9810")->effect.keeps_place);
  EXPECT_EQ(text_of(*words->find("G65 P9810")), "G65 P9810: moves, position unknown");
  // Nothing is said of the modes behind it.
  EXPECT_FALSE(words->find("L054")->effect.keeps_modes);
}

TEST(OwnWordList, SaysNothingWhereNothingIsVouchedFor) {
  EXPECT_EQ(OwnWordList().words(), nullptr);
}

struct WrongWord {
  std::string text;
  std::string said;
};

class WrongOwnWords : public testing::TestWithParam<WrongWord> {};

TEST_P(WrongOwnWords, AreToldWithWhatIsAllowed) {
  const auto problems = problems_with({GetParam().text});
  ASSERT_EQ(problems.size(), 1U) << GetParam().text;
  EXPECT_NE(problems.front().find(GetParam().said), std::string::npos) << problems.front();
}

INSTANTIATE_TEST_SUITE_P(
    OfEachKind, WrongOwnWords,
    testing::Values(
        // Batten's own meaning goes before what a user believes.
        WrongWord{"M8 = keeps state", "Batten knows what M8 does"},
        WrongWord{"G68 = keeps state", "Batten knows what G68 does"},
        WrongWord{"G92 = keeps state", "Batten knows what G92 does"},
        WrongWord{"G51.1 = position unknown", "Batten knows what G51.1 does"},
        WrongWord{"G51 = keeps state", "all that can be said of it is 'position unknown'"},
        WrongWord{"G52 = moves", "all that can be said of it is 'position unknown'"},
        WrongWord{"G54 = ends a run, position unknown; moves", "all that can be said of it"},
        WrongWord{"G65 = keeps state", "name the program, such as G65 P9810"},
        WrongWord{"TRAORI = keeps state", "Batten knows what TRAORI does"},
        WrongWord{"M501 P1 = keeps state", "'M501 P1' is no word; expected one like M501"},
        WrongWord{"G12345 = keeps state", "is no word"},
        WrongWord{"501 = keeps state", "is no word"},
        WrongWord{"o#1 call = keeps state", "is no word"},
        WrongWord{"X5 = keeps state", "is no word"}, WrongWord{"= keeps state", "is no word"},
        WrongWord{"M501 keeps state", "expected a word and what it does"},
        WrongWord{"M501 = keep state", "did you mean 'keeps state'"},
        WrongWord{"M501 = rotates", "possible: keeps state, ends a run, position unknown"},
        WrongWord{"M501 = ", "there is no effect ''"},
        WrongWord{"M501 = keeps state, returns", "'returns' is said of calls only"},
        WrongWord{"M501 = keeps state, moves", "contradicts itself"},
        WrongWord{"L54 = position unknown; keeps state", "contradicts itself"}));

TEST(OwnWordList, TellsAllProblemsAtOnce) {
  EXPECT_EQ(problems_with({"M8 = keep state", "M77 = rotates", "bad"}).size(), 4U);
}

TEST(OwnWordList, RefusesTwoOpinionsOfOneWord) {
  EXPECT_TRUE(problems_with({"M501 = keeps state", "M0501 = ends a run"}).empty());
  const auto problems = problems_with({"M501 = keeps state", "M501 = moves"});
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems.front().find("'keeps state' where it was named before"), std::string::npos);
}

}  // namespace
}  // namespace batten::postproc
