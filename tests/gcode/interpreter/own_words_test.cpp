// What is known behind words that a user vouches for: as much as was said, and nothing of words
// that only look alike.
#include "gcode/state/own_words.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/state/reason.h"
#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

constexpr const char* kKnownBefore = "G21 G90 G94 G17 G40 G49 G64\nG54\nG0 X1 Y1 Z1\nG1 X2 F100\n";

OwnEffect effect_named(std::string_view name) {
  return std::ranges::find(own_effects(), name, &OwnEffectRow::name)->effect;
}

ReadOptions vouching(const std::vector<std::pair<std::string, std::string>>& words,
                     bool returns = true) {
  std::vector<OwnWord> all;
  for (const auto& [name, effect] : words) {
    all.push_back({name, effect, effect_named(effect)});
    all.back().effect.returns = returns;
  }
  ReadOptions options;
  options.own_words = std::make_shared<const OwnWords>(std::move(all));
  return options;
}

tests::Interpreted after_head(const std::string& text, const ReadOptions& options) {
  return {std::string(kKnownBefore) + text, options};
}

// Does the block behind `text` cut from a known place, under known modes and a known feed?
bool cuts_behind(const std::string& text, const ReadOptions& options,
                 const std::string& cut = "X3 Y2 Z2\n") {
  const tests::Interpreted it = after_head(text + "\n" + cut, options);
  const Motion* motion = it.motion_of_line(it.read.blocks.size());
  return motion != nullptr && motion->start_known && is_known(it.last_state()) &&
         it.last_state().feed == 100;
}

struct VouchedCase {
  std::string text;
  std::string name;
};

class VouchedWords : public testing::TestWithParam<VouchedCase> {};

TEST_P(VouchedWords, LeaveAllAsItWasWhereTheyKeepIt) {
  const auto& [text, name] = GetParam();
  EXPECT_FALSE(cuts_behind(text, {})) << "known without the user's word";
  EXPECT_TRUE(cuts_behind(text, vouching({{name, "keeps state"}})));
  EXPECT_TRUE(cuts_behind(text, vouching({{name, "ends a run"}})));
}

TEST_P(VouchedWords, LeaveNoPlaceKnownThatTheyLose) {
  const auto& [text, name] = GetParam();
  for (const char* effect : {"position unknown", "moves"}) {
    const ReadOptions options = vouching({{name, effect}});
    EXPECT_FALSE(cuts_behind(text, options)) << effect;
    EXPECT_FALSE(cuts_behind(text, options, "X3 F100\n")) << effect;
    EXPECT_TRUE(cuts_behind(text, options, "G1 X3 Y2 Z2 F100\nX4\n")) << effect;
  }
}

// The word may have chosen another work offset: G54 then comes back, from elsewhere.
TEST_P(VouchedWords, LeaveNoWorkOffsetKnownWhereTheyLoseThePlace) {
  const auto& [text, name] = GetParam();
  const std::string back = text + "\nG1 X3 Y2 Z2 F100\nG54\n";
  EXPECT_FALSE(cuts_behind(back, vouching({{name, "position unknown"}}), "X4\n"));
  EXPECT_FALSE(cuts_behind(back, vouching({{name, "moves"}}), "X4\n"));
  EXPECT_TRUE(cuts_behind(back, vouching({{name, "keeps state"}}), "X4\n"));
}

// Who cuts on under the G1 and the F of before would cut at the feed of the macro.
TEST_P(VouchedWords, LeaveNoFeedAndNoKindOfMotionKnownWhereTheyMove) {
  const auto& [text, name] = GetParam();
  const tests::Interpreted it = after_head(text + "\n", vouching({{name, "moves"}}));
  EXPECT_FALSE(it.last_state().feed.has_value());
  EXPECT_EQ(it.last_state().motion, MotionMode::kUnknown);
  EXPECT_TRUE(is_known(it.last_state()));
}

TEST_P(VouchedWords, EndARunAndAreCopied) {
  const auto& [text, name] = GetParam();
  const tests::Interpreted it = after_head(text + "\n", vouching({{name, "keeps state"}}));
  EXPECT_EQ(it.read.blocks.back().kind, BlockKind::kOpaque);
  EXPECT_FALSE(it.read.blocks.back().barrier.empty());
}

INSTANTIATE_TEST_SUITE_P(
    OfEachForm, VouchedWords,
    testing::Values(VouchedCase{"M501", "M501"}, VouchedCase{"M501 P1 Q2", "M501"},
                    VouchedCase{"G100", "G100"}, VouchedCase{"G100.1 P3", "G100.1"},
                    VouchedCase{"G65 P9810 A1. X5.", "G65 P9810"},
                    VouchedCase{"G65 P9810 A#1", "G65 P9810"},
                    VouchedCase{"M98 P9001", "M98 P9001"}, VouchedCase{"M98 P9001 L5", "M98 P9001"},
                    VouchedCase{"M198 P12", "M198 P12"},
                    // Zero points of a Philips control.
                    VouchedCase{"G51", "G51"}, VouchedCase{"G52", "G52"}, VouchedCase{"G55", "G55"},
                    VouchedCase{"o<probe> call", "O<PROBE> CALL"},
                    VouchedCase{"O 100 CALL [#1] [2]", "O100 CALL"}));

// Each is a program that would be cut wrongly if the word that is vouched for were taken for more
// than it is.
struct OtherCase {
  std::string text;
  std::string name;  // "keeps state" is said of it
  std::string next = "X3 Y2 Z2\n";
};

class WordsThatLookAlike : public testing::TestWithParam<OtherCase> {};

TEST_P(WordsThatLookAlike, AreAsUnknownAsBefore) {
  const auto& [text, name, next] = GetParam();
  EXPECT_FALSE(cuts_behind(text, vouching({{name, "keeps state"}}), next));
}

INSTANTIATE_TEST_SUITE_P(
    OfEachForm, WordsThatLookAlike,
    testing::Values(OtherCase{"M502", "M501"}, OtherCase{"G101", "G100"},
                    OtherCase{"G100.1", "G100"}, OtherCase{"G51.1 X0", "G51"},
                    OtherCase{"G52 X5", "G51", "X3\n"}, OtherCase{"G51 G68 R30", "G51"},
                    // The operator may skip it.
                    OtherCase{"/G51 X5", "G51", "X3\n"}, OtherCase{"M501 M502", "M501"},
                    OtherCase{"M501 G101", "M501"}, OtherCase{"G65 P19810", "G65 P9810"},
                    OtherCase{"G65 P#1", "G65 P9810"}, OtherCase{"G66 P9810", "G65 P9810"},
                    OtherCase{"M98 P9001", "G65 P9001"}, OtherCase{"M98 P59001", "M98 P9001"},
                    // From block 5 of it on.
                    OtherCase{"M98 P9001 H5", "M98 P9001"},
                    // The program starts again, or goes back.
                    OtherCase{"M98 P9001 M99", "M98 P9001"},
                    OtherCase{"o<probe2> call", "O<PROBE> CALL"},
                    OtherCase{"o<probe> sub", "O<PROBE> CALL"}, OtherCase{"o#1 call", "O1 CALL"},
                    // Axis words may be arguments, and the tool not there.
                    OtherCase{"M501 X50", "M501", "X3\n"}, OtherCase{"G100 X50", "G100", "X3\n"},
                    OtherCase{"G100 F5", "G100"}, OtherCase{"M501 T5", "M501"},
                    // The user says nothing of the words beside it.
                    OtherCase{"M501 G92 X0", "M501", "X3\n"},
                    // The operator may skip the change of the feed.
                    OtherCase{"/M501 F5", "M501"}));

// M99 P100 of a macro goes on at N100: what stands before it was not done.
TEST(VouchedCalls, MayComeBackAtALabelUnlessTheySurelyReturn) {
  const std::string program = "G65 P9810\nX3 Y2 Z2\nN100 X4\n";
  const tests::Interpreted returns =
      after_head(program, vouching({{"G65 P9810", "keeps state"}}, true));
  EXPECT_FALSE(returns.read.blocks.back().entered_from_elsewhere);
  EXPECT_TRUE(is_known(returns.last_state()));
  const tests::Interpreted may_not =
      after_head(program, vouching({{"G65 P9810", "keeps state"}}, false));
  EXPECT_TRUE(may_not.read.blocks.back().entered_from_elsewhere);
  EXPECT_FALSE(is_known(may_not.last_state()));
  // One call that is known says nothing of another.
  const tests::Interpreted other =
      after_head("G65 P9811\n" + program, vouching({{"G65 P9810", "keeps state"}}, true));
  EXPECT_TRUE(other.read.blocks.back().entered_from_elsewhere);
}

// --- Sinumerik, Klartext
// --------------------------------------------------------------------------

struct OtherLanguageCase {
  Language language;
  std::string program;  // the last block but one is the word, the last one cuts
  std::string name;
  bool taken = true;
};

class VouchedInOtherLanguages : public testing::TestWithParam<OtherLanguageCase> {};

TEST_P(VouchedInOtherLanguages, AreTakenWhereTheWholeBlockIsThatCall) {
  const auto& [language, text, name, taken] = GetParam();
  Diagnostics found;
  Reading reading;
  reading.language = language;
  const Program program = parse(SourceText("test", std::string(text)), reading, found);
  const Interpretation read = interpret(program, vouching({{name, "keeps state"}}), found);
  ASSERT_FALSE(read.motions.empty());
  const BlockMeaning& last = read.blocks.back();
  const bool cuts = last.motion >= 0 && read.motions.back().start_known &&
                    is_known(read.states.at(last.state_after));
  EXPECT_EQ(cuts, taken);
}

constexpr const char* kSiemens = "G71 G90 G17 G94 G40\nG0 X1 Y1 Z1\nG1 X2 F100\n";
std::string siemens(const std::string& line) { return kSiemens + line + "\nX3 Y2 Z2"; }
std::string klartext(const std::string& line) {
  return "0 BEGIN PGM A MM\n1 L X+1 Y+1 Z+1 R0 F100\n2 " + line + "\n3 L X+3 Y+2 Z+2";
}

INSTANTIATE_TEST_SUITE_P(
    OfEachForm, VouchedInOtherLanguages,
    testing::Values(
        OtherLanguageCase{Language::kSiemens, siemens("L54"), "L54"},
        OtherLanguageCase{Language::kSiemens, siemens("N10 L54 P3 ; twice"), "L54"},
        OtherLanguageCase{Language::kSiemens, siemens("PROBE_Z(1, \"A\")"), "PROBE_Z"},
        OtherLanguageCase{Language::kSiemens, siemens("M501"), "M501"},
        OtherLanguageCase{Language::kSiemens, siemens("G100"), "G100"},
        // Zeros count, MCALL calls again and again, and a branch may not call.
        OtherLanguageCase{Language::kSiemens, siemens("L054"), "L54", false},
        OtherLanguageCase{Language::kSiemens, siemens("MCALL L54"), "L54", false},
        OtherLanguageCase{Language::kSiemens, siemens("IF R1==0 L54"), "L54", false},
        OtherLanguageCase{Language::kSiemens, siemens("L54 X5"), "L54", false},
        OtherLanguageCase{Language::kSiemens, siemens("PROBE_Z=5"), "PROBE_Z", false},
        OtherLanguageCase{Language::kKlartext, klartext("CALL PGM probe.h"), "CALL PGM PROBE"},
        OtherLanguageCase{Language::kKlartext, klartext("CALL PGM TNC:\\A\\PROBE"),
                          "CALL PGM PROBE", false},
        OtherLanguageCase{Language::kKlartext, klartext("CALL LBL 1"), "CALL PGM PROBE", false}));

}  // namespace
}  // namespace batten::gcode
