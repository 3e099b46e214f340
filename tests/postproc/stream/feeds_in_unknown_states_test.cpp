// F words where the state of the control is not known, or where what uses them is not followed:
// behind calls, labels and unknown words, before cycles and user functions, at a change of units.
// The verifier must compare each of them, in every language.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <sstream>

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

constexpr std::string_view kRs274Begin = "G21 G90 G17 G94\nG0 X0 Y0 Z0\n";
constexpr std::string_view kSiemensBegin = "G71 G90 G17 G94\nG0 X0 Y0 Z0\n";
constexpr std::string_view kKlartextBegin =
    "BEGIN PGM A MM\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+0 R0 FMAX\n";

// On each line of `table` a name and, after |, blocks with F750; "\\n" ends one.
void expect_feeds_compared(Language language, std::string_view begin, std::string_view table) {
  std::istringstream rows{std::string(table)};
  for (std::string row; std::getline(rows, row);) {
    if (row.empty()) continue;
    SCOPED_TRACE(row);
    std::string text(begin);
    for (std::size_t at = row.find('|') + 1; at < row.size();) {
      const std::size_t end = row.find("\\n", at);
      text += row.substr(at, end - at) + "\n";
      at = end + 2;
    }
    EXPECT_TRUE(is_proved(text, text + "\n", language)) << "an empty line more";
    EXPECT_FALSE(is_proved(text, replaced(text, "F750", "F75"), language));
    EXPECT_FALSE(is_proved(text, replaced(text, "F750", ""), language));
    EXPECT_FALSE(is_proved(replaced(text, "F750", ""), text, language));
  }
}

TEST(FeedsInUnknownStates, AreComparedInRs274) {
  expect_feeds_compared(Language::kRs274, kRs274Begin, R"(
AloneBehindACall|M98 P1\nF750\nG1 X5\nM30\n
BesideCoolantBehindACall|M98 P1\nM8 F750\nG1 X5\nM30\n
BesideG1BehindACall|M98 P1\nG1 F750\nX5\nM30\n
AmongWordsBehindACall|M98 P1\nG55 S375 F750 M3 M8\nG1 X5\nM30\n
BehindAMacro|G65 P9010\nF750\nG1 X5\nM30\n
BehindAnOWord|o100 call\nF750\nG1 X5\nM30\n
BehindALabel|N10 X1\nF750\nG1 X5\nGOTO 10\nM30\n
BehindAnUnknownWord|G123\nF750\nG1 X5\nM30\n
BehindTheEnd|M30\nF750\nG1 X5\n
InALoop|WHILE[#1LT5]DO1\nF750\nG1 X5\nEND1\nM30\n
BeforeACall|F750\nM98 P1\nG1 X5 F9\nM30\n
BeforeAUserFunction|F750\nM101\nG1 X5 F9\nM30\n
BeforeATappingMove|F750\nG63 Z-5\nG1 X5 F9\nM30\n
BeforeAToolChange|F750\nM6\nG1 X5 F9\nM30\n
BeforeOtherUnits|F750\nG20\nG1 X5\nM30\n
BeforeUnitsBehindACall|M98 P1\nF750\nG20\nG1 X5\nM30\n
BeforeInverseTime|F750\nG93\nG1 X5\nM30\n
OfARapid|G1 X5 F9\nG0 X6 F750\nG1 X5 F9\nM30\n
BeforeTheEndOfASubprogram|G1 X5 F9\nF750\nM99\n
BeforeTheEnd|G1 X5 F9\nF750\nM30\n
AtTheEndOfTheText|G1 X5 F9\nF750\n
)");
}

TEST(FeedsInUnknownStates, RepeatNoneThatStandsBesideOtherUnits) {
  const std::string_view cuts = "\nX2\nM30\n";
  for (const auto& [units, proved] : {std::pair("G20 F9", false), std::pair("G21 F9", true)}) {
    const std::string begin = fmt::format("{}{}\nG1 X1", kRs274Begin, units);
    const auto with = fmt::format("{} F9{}", begin, cuts);
    const auto without = fmt::format("{}{}", begin, cuts);
    EXPECT_EQ(is_proved(with, without, Language::kRs274), proved) << units;
    EXPECT_EQ(is_proved(without, with, Language::kRs274), proved) << units;
  }
}

TEST(FeedsInUnknownStates, AreComparedInSiemensPrograms) {
  expect_feeds_compared(Language::kSiemens, kSiemensBegin, R"(
BehindASubprogram|L100 P1\nF750\nG1 X5\nM30\n
BehindAnUnknownName|FOO(1)\nM8 F750\nG1 X5\nM30\n
BehindALabel|L1: X1\nG1 F750\nX5\nGOTOB L1\nM30\n
BeforeAModalCall|F750\nMCALL CYCLE81(1,2,3)\nG0 X5\nMCALL\nG1 X7 F9\nM30\n
BeforeAModalCallInAnUnknownState|FOO(1)\nF750\nMCALL CYCLE81(1,2,3)\nG0 X5\nMCALL\nG1 X7 F9\nM30\n
BeforeATappingMove|F750\nG63 Z-5\nG1 X5 F9\nM30\n
BeforeG973|F750\nG973\nG1 X5\nM30\n
InALoop|LOOP\nF750\nG1 X5\nENDLOOP\nM30\n
)");
}

TEST(FeedsInUnknownStates, AreComparedInKlartext) {
  expect_feeds_compared(Language::kKlartext, kKlartextBegin, R"(
BehindACall|CALL LBL 1\nL F750\nL X+5\nEND PGM A MM\n
BesideCoolantBehindACall|CALL LBL 1\nL F750 M8\nL X+5\nEND PGM A MM\n
BehindAProgram|CALL PGM B\nL F750\nL X+5\nEND PGM A MM\n
BehindALabel|LBL 1\nL F750\nL X+5\nCALL LBL 1 REP 2\nEND PGM A MM\n
BehindAnUnknownWord|FOO 1\nL F750\nL X+5\nEND PGM A MM\n
BesideFmax|L X+5 FMAX F750\nL X+7 F9\nEND PGM A MM\n
BeforeACycle|L X+5 F9\nL F750\nCYCL CALL\nL X+7 F9\nEND PGM A MM\n
)");
}

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

struct Damaged {
  std::string before;
  std::string after;
};

std::string without_feed(std::string block) {
  const std::size_t at = block.find('@');
  const std::size_t begin = block[at - 1] == '=' ? at - 2 : at - 1;
  return block.erase(begin, at + 1 - begin);
}

// Each feed is one of its own, and used before the next one; one is changed, lost or added.
Damaged random_feeds(const Blocks& blocks, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return random() % n; };
  int place = 0;
  const auto block_of = [&](const std::vector<std::string_view>& from) {
    const std::string block(from[below(from.size())]);
    const bool has_place = block.find('$') < block.find("$P");
    return (has_place ? replaced(block, "$", std::to_string(++place)) : block) + "\n";
  };
  Damaged both{std::string(blocks.begin), std::string(blocks.begin)};
  const auto add = [&](const std::string& before, const std::string& after) {
    both.before += before;
    both.after += after;
  };
  const std::size_t steps = 1 + below(6);
  const std::size_t wrong = below(steps);
  const std::size_t damage = below(3);
  for (std::size_t step = 0; step < steps; ++step) {
    const std::string unknown = block_of(blocks.unknown);
    add(unknown, unknown);
    const std::string feed = block_of(blocks.feeds);
    const std::string said = replaced(feed, "@", std::to_string(100 + 7 * step));
    const std::string none = without_feed(feed);
    if (step != wrong) {
      add(said, said);
    } else if (damage == 0) {
      add(said, replaced(feed, "@", std::to_string(100 + 7 * step) + "0"));
    } else {
      add(damage == 1 ? said : none, damage == 1 ? none : said);
    }
    const std::string use = block_of(blocks.uses);
    add(use, use);
  }
  add(std::string(blocks.end), std::string(blocks.end));
  return both;
}

TEST(RandomFeeds, ThatAreChangedLostOrAddedAreNeverProved) {
  constexpr std::uint32_t kPrograms = 2000;
  for (const Blocks& blocks : blocks_of_languages()) {
    for (std::uint32_t seed = 0; seed < kPrograms; ++seed) {
      const Damaged both = random_feeds(blocks, seed);
      ASSERT_FALSE(is_proved(both.before, both.after, blocks.language)) << "seed " << seed << "\n"
                                                                        << both.before << "---\n"
                                                                        << both.after;
      ASSERT_TRUE(is_proved(both.before, both.before + "\n", blocks.language)) << both.before;
    }
  }
}

}  // namespace
}  // namespace batten::postproc
