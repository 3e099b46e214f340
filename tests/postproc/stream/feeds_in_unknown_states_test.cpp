// F words where the state of the control is not known, or where what uses them is not followed:
// behind calls, labels and unknown words, before cycles and user functions, at a change of units.
// The verifier must compare each of them, in every language.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using gcode::Language;

bool is_proved(const std::string& before, const std::string& after, Language language) {
  const ReadText old_text(before, language);
  const ReadText new_text(after, language);
  return verify({&old_text.program, &old_text.meaning}, {&new_text.program, &new_text.meaning},
                0.05)
      .proved();
}

// --- one by one ---------------------------------------------------------------------------------

constexpr std::string_view kRs274Begin = "G21 G90 G17 G94\nG0 X0 Y0 Z0\n";
constexpr std::string_view kSiemensBegin = "G71 G90 G17 G94\nG0 X0 Y0 Z0\n";
constexpr std::string_view kKlartextBegin =
    "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+0 R0 FMAX\n";

struct FeedCase {
  std::string name;
  Language language;
  std::string blocks;  // with F750
};

void PrintTo(const FeedCase& test, std::ostream* out) { *out << test.name; }

class FeedInAnUnknownState : public testing::TestWithParam<FeedCase> {};

TEST_P(FeedInAnUnknownState, IsCompared) {
  const Language language = GetParam().language;
  const std::string_view begin = language == Language::kRs274     ? kRs274Begin
                                 : language == Language::kSiemens ? kSiemensBegin
                                                                  : kKlartextBegin;
  const std::string text = std::string(begin) + GetParam().blocks;
  EXPECT_TRUE(is_proved(text, text + "\n", language)) << "an empty line more";
  EXPECT_FALSE(is_proved(text, replaced(text, "F750", "F75"), language));
  EXPECT_FALSE(is_proved(text, replaced(text, "F750", ""), language));
  EXPECT_FALSE(is_proved(replaced(text, "F750", ""), text, language));
}

INSTANTIATE_TEST_SUITE_P(
    Rs274, FeedInAnUnknownState,
    testing::Values(
        FeedCase{"AloneBehindACall", Language::kRs274, "M98 P1\nF750\nG1 X5\nM30\n"},
        FeedCase{"BesideCoolantBehindACall", Language::kRs274, "M98 P1\nM8 F750\nG1 X5\nM30\n"},
        FeedCase{"BesideG1BehindACall", Language::kRs274, "M98 P1\nG1 F750\nX5\nM30\n"},
        FeedCase{"AmongWordsBehindACall", Language::kRs274,
                 "M98 P1\nG55 S375 F750 M3 M8\nG1 X5\nM30\n"},
        FeedCase{"BehindAMacro", Language::kRs274, "G65 P9010\nF750\nG1 X5\nM30\n"},
        FeedCase{"BehindAnOWord", Language::kRs274, "o100 call\nF750\nG1 X5\nM30\n"},
        FeedCase{"BehindALabel", Language::kRs274, "N10 X1\nF750\nG1 X5\nGOTO 10\nM30\n"},
        FeedCase{"BehindAnUnknownWord", Language::kRs274, "G123\nF750\nG1 X5\nM30\n"},
        FeedCase{"BehindTheEnd", Language::kRs274, "M30\nF750\nG1 X5\n"},
        FeedCase{"InALoop", Language::kRs274, "WHILE[#1LT5]DO1\nF750\nG1 X5\nEND1\nM30\n"},
        FeedCase{"BeforeACall", Language::kRs274, "F750\nM98 P1\nG1 X5 F9\nM30\n"},
        FeedCase{"BeforeAUserFunction", Language::kRs274, "F750\nM101\nG1 X5 F9\nM30\n"},
        FeedCase{"BeforeATappingMove", Language::kRs274, "F750\nG63 Z-5\nG1 X5 F9\nM30\n"},
        FeedCase{"BeforeAToolChange", Language::kRs274, "F750\nM6\nG1 X5 F9\nM30\n"},
        FeedCase{"BeforeOtherUnits", Language::kRs274, "F750\nG20\nG1 X5\nM30\n"},
        FeedCase{"BeforeUnitsBehindACall", Language::kRs274, "M98 P1\nF750\nG20\nG1 X5\nM30\n"},
        FeedCase{"BeforeInverseTime", Language::kRs274, "F750\nG93\nG1 X5\nM30\n"},
        FeedCase{"OfARapid", Language::kRs274, "G1 X5 F9\nG0 X6 F750\nG1 X5 F9\nM30\n"},
        FeedCase{"BeforeTheEndOfASubprogram", Language::kRs274, "G1 X5 F9\nF750\nM99\n"},
        FeedCase{"BeforeTheEnd", Language::kRs274, "G1 X5 F9\nF750\nM30\n"},
        FeedCase{"AtTheEndOfTheText", Language::kRs274, "G1 X5 F9\nF750\n"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Siemens, FeedInAnUnknownState,
    testing::Values(
        FeedCase{"BehindASubprogram", Language::kSiemens, "L100 P1\nF750\nG1 X5\nM30\n"},
        FeedCase{"BehindAnUnknownName", Language::kSiemens, "FOO(1)\nM8 F750\nG1 X5\nM30\n"},
        FeedCase{"BehindALabel", Language::kSiemens, "L1: X1\nG1 F750\nX5\nGOTOB L1\nM30\n"},
        FeedCase{"BeforeAModalCall", Language::kSiemens,
                 "F750\nMCALL CYCLE81(1,2,3)\nG0 X5\nMCALL\nG1 X7 F9\nM30\n"},
        FeedCase{"BeforeAModalCallInAnUnknownState", Language::kSiemens,
                 "FOO(1)\nF750\nMCALL CYCLE81(1,2,3)\nG0 X5\nMCALL\nG1 X7 F9\nM30\n"},
        FeedCase{"BeforeATappingMove", Language::kSiemens, "F750\nG63 Z-5\nG1 X5 F9\nM30\n"},
        FeedCase{"BeforeG973", Language::kSiemens, "F750\nG973\nG1 X5\nM30\n"},
        FeedCase{"InALoop", Language::kSiemens, "LOOP\nF750\nG1 X5\nENDLOOP\nM30\n"}),
    [](const auto& test) { return test.param.name; });

INSTANTIATE_TEST_SUITE_P(
    Klartext, FeedInAnUnknownState,
    testing::Values(
        FeedCase{"BehindACall", Language::kKlartext, "CALL LBL 1\nL F750\nL X+5\nEND PGM A MM\n"},
        FeedCase{"BesideCoolantBehindACall", Language::kKlartext,
                 "CALL LBL 1\nL F750 M8\nL X+5\nEND PGM A MM\n"},
        FeedCase{"BehindAProgram", Language::kKlartext,
                 "CALL PGM B\nL F750\nL X+5\nEND PGM A MM\n"},
        FeedCase{"BehindALabel", Language::kKlartext,
                 "LBL 1\nL F750\nL X+5\nCALL LBL 1 REP 2\nEND PGM A MM\n"},
        FeedCase{"BehindAnUnknownWord", Language::kKlartext,
                 "FOO 1\nL F750\nL X+5\nEND PGM A MM\n"},
        FeedCase{"BesideFmax", Language::kKlartext, "L X+5 FMAX F750\nL X+7 F9\nEND PGM A MM\n"},
        FeedCase{"BeforeACycle", Language::kKlartext,
                 "L X+5 F9\nL F750\nCYCL CALL\nL X+7 F9\nEND PGM A MM\n"}),
    [](const auto& test) { return test.param.name; });

// --- random programs ----------------------------------------------------------------------------

struct Blocks {
  Language language;
  std::string_view begin;
  std::vector<std::string_view> unknown;  // make the state unknown, or do nothing
  std::vector<std::string_view> feeds;    // @ is the feed
  std::vector<std::string_view> uses;     // act with the feed, or may; $ is a place
  std::string_view end;
};

std::vector<Blocks> blocks_of_languages() {
  return {
      {Language::kRs274,
       kRs274Begin,
       {"", "", "M98 P1", "G65 P9010", "o100 call", "G123", "#5221=1", "IF[#1EQ1]THEN#5221=1",
        "N10 M8", "M101", "WHILE[#1LT5]DO1", "END1", "G20", "G21", "G93", "G94", "/G91", "G1 X",
        "G68 R30"},
       {"F@", "f@", "M8 F@", "G1 F@", "G55 S375 F@ M3", "G1 X$ F@", "G0 X$ F@", "G0 F@", "N7 F@",
        "G94 F@"},
       {"G1 X$", "G1 X$ M9", "G0 X$", "M8", "M101", "M98 P1", "G20", "G93", "G81 X$ Z-1 R1",
        "GOTO 10", "X#1", "M6", "G63 Z-$"},
       "M30\n"},
      {Language::kSiemens,
       kSiemensBegin,
       {"", "", "L100", "FOO(1)", "L1:", "LOOP", "ENDLOOP", "IF R1>5 GOTOF L1", "TRAORI", "G95",
        "G94", "$P_UIFR[1]=5", "CYCLE800()", "MCALL", "G971"},
       {"F@", "M8 F@", "G1 F@", "G55 S375 F@ M3", "G1 X$ F@", "G1 X=$ F@", "F=@", "G0 F@"},
       {"G1 X$", "G1 X$ M9", "G0 X$", "M8", "FOO(2)", "MCALL CYCLE81(1,2,3)", "GOTOB L1", "G63 Z-$",
        "G973", "M101", "L100"},
       "M30\n"},
      {Language::kKlartext,
       kKlartextBegin,
       {"", "", "CALL LBL 1", "LBL 1", "LBL 2", "CALL PGM B", "FOO 1", "M136", "M137",
        "PLANE RESET STAY", "FN 9: IF +Q1 EQU +1 GOTO LBL 1"},
       {"L F@", "L F@ M8", "L X+$ F@", "L X+$ R0 F@ M8", "C X+$ Y+0 DR- F@"},
       {"L X+$", "L X+$ FMAX", "M8", "CYCL CALL", "CALL LBL 1", "L X+$ M9", "STOP", "CALL PGM B"},
       "END PGM A MM\n"},
  };
}

class RandomFeeds {
 public:
  RandomFeeds(const Blocks& blocks, std::uint32_t seed) : blocks_(blocks), random_(seed) {}

  struct Damaged {
    std::string before;
    std::string after;
  };

  // Each feed is one of its own, and used before the next one.
  Damaged program() {
    std::string text(blocks_.begin);
    const std::size_t steps = 1 + below(6);
    const std::size_t wrong = below(steps);
    const std::size_t damage = below(3);
    Damaged both{text, text};
    for (std::size_t step = 0; step < steps; ++step) {
      add(both, block_of(blocks_.unknown));
      const std::string feed = block_of(blocks_.feeds);
      const std::string number = std::to_string(100 + 7 * step);
      if (step != wrong) {
        add(both, replaced(feed, "@", number));
      } else if (damage == 0) {
        both.before += replaced(feed, "@", number) + "\n";
        both.after += replaced(feed, "@", number + "0") + "\n";
      } else {
        std::string& with = damage == 1 ? both.before : both.after;
        std::string& without = damage == 1 ? both.after : both.before;
        with += replaced(feed, "@", number) + "\n";
        without += without_feed(feed) + "\n";
      }
      add(both, block_of(blocks_.uses));
    }
    add(both, std::string(blocks_.end));
    return both;
  }

 private:
  std::size_t below(std::size_t n) { return random_() % n; }

  static void add(Damaged& both, const std::string& block) {
    both.before += block + "\n";
    both.after += block + "\n";
  }

  std::string block_of(const std::vector<std::string_view>& blocks) {
    std::string block(blocks[below(blocks.size())]);
    if (block.find('$') != std::string::npos && block.find("$P") == std::string::npos) {
      block = replaced(block, "$", std::to_string(++place_));
    }
    return block;
  }

  static std::string without_feed(std::string block) {
    const std::size_t at = block.find('@');
    const std::size_t begin = block[at - 1] == '=' ? at - 2 : at - 1;
    return block.erase(begin, at + 1 - begin);
  }

  const Blocks& blocks_;
  std::mt19937 random_;
  int place_ = 0;
};

TEST(RandomFeeds, ThatAreChangedLostOrAddedAreNeverProved) {
  constexpr std::uint32_t kPrograms = 2000;
  for (const Blocks& blocks : blocks_of_languages()) {
    for (std::uint32_t seed = 0; seed < kPrograms; ++seed) {
      const auto both = RandomFeeds(blocks, seed).program();
      ASSERT_FALSE(is_proved(both.before, both.after, blocks.language)) << "seed " << seed << "\n"
                                                                        << both.before << "---\n"
                                                                        << both.after;
      ASSERT_TRUE(is_proved(both.before, both.before + "\n", blocks.language)) << both.before;
    }
  }
}

}  // namespace
}  // namespace batten::postproc
