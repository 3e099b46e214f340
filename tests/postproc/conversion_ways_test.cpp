// Programs converted from each language to each other one: the same acts in three languages,
// derived by hand; what is refused, and where; round trips; that the proof finds every damage.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/proof/common_events.h"
#include "tests/support/klartext_programs.h"
#include "wavy_programs.h"

namespace batten::postproc {
namespace {

using gcode::Language;

SmoothOptions ways_to(std::string_view target) {
  SmoothOptions options = options_for(target);
  options.convert = true;
  options.allowed = {"work-offset", "tool-length", "blank-form"};
  options.method = Method::kNone;
  return options;
}

struct ReadAs {
  ReadAs(const std::string& text, Language language, const gcode::CurveFormat* curves = nullptr)
      : program(gcode::parse(gcode::SourceText("test.nc", text), language, found)),
        meaning(gcode::interpret(program, {.curves = curves}, found)) {}
  [[nodiscard]] ReadProgram read() const { return {&program, &meaning}; }
  gcode::Diagnostics found;
  gcode::Program program;
  gcode::Interpretation meaning;
};

bool is_proved(const std::string& before, Language from, const std::string& after, Language to,
               double tolerance_mm = 0.01) {
  const ReadAs old_text(before, from);
  const ReadAs new_text(after, to);
  return verify(old_text.read(), new_text.read(), tolerance_mm).proved();
}

// "line:column: message" of each error.
std::vector<std::string> told(const SmoothResult& result, const std::string& text) {
  std::vector<std::string> all;
  for (const gcode::Diagnostic& each : result.diagnostics) {
    if (each.severity != gcode::Severity::kError) continue;
    const std::string before = text.substr(0, each.where.begin);
    const std::size_t line_begin = before.rfind('\n') + 1;
    all.push_back(fmt::format("{}:{}: {}", std::ranges::count(before, '\n') + 1,
                              before.size() - line_begin + 1, each.message));
  }
  return all;
}

std::string as_klartext(const std::string& lines) {
  return tests::numbered_from_zero(lines_of("BEGIN PGM TEST MM\n" + lines + "END PGM TEST MM\n"));
}

// --- one act in three languages -----------------------------------------------------------------

struct ActCase {
  const char* name;
  const char* plain;
  const char* siemens;
  const char* klartext;
};

// Behind a first rapid to X0 Y0 Z5, or before it.
constexpr ActCase kActs[] = {
    {"Rapid", "X1 Y-2.5\n", "X1 Y-2.5\n", "L X+1 Y-2.5 FMAX\n"},
    {"Lines", "G1 X1 F500\nY2 F600\nX3 Y4 Z-1.25\n", "G1 X1 F500\nY2 F600\nX3 Y4 Z-1.25\n",
     "L X+1 F500\nL Y+2 F600\nL X+3 Y+4 Z-1.25\n"},
    {"RapidBetweenLines", "G1 X1 F500\nG0 Z6\nG1 Z5\n", "G1 X1 F500\nG0 Z6\nG1 Z5\n",
     "L X+1 F500\nL Z+6 FMAX\nL Z+5\n"},
    // A quarter about (10, 0): from 180 degrees to 90, to 270.
    {"Clockwise", "G2 X10 Y10 I10 F500\n", "G2 X10 Y10 I10 F500\n",
     "CC X+10 Y+0\nC X+10 Y+10 DR- F500\n"},
    {"Counterclockwise", "G3 X10 Y-10 I10 F500\n", "G3 X10 Y-10 I10 F500\n",
     "CC X+10 Y+0\nC X+10 Y-10 DR+ F500\n"},
    // About (3, 4), by 180 degrees.
    {"HalfTurn", "G3 X6 Y8 I3 J4 F500\n", "G3 X6 Y8 I3 J4 F500\n",
     "CC X+3 Y+4\nC X+6 Y+8 DR+ F500\n"},
    {"Tool", "T5 M6\nG43 H5\nS3000 M3\nG0 X1 Y1\nZ3\n", "T5 M6\nD1\nS3000 M3\nG0 X1 Y1\nZ3\n",
     "TOOL CALL 5 Z S3000\nM3\nL X+1 Y+1 FMAX\nL Z+3 FMAX\n"},
    {"ToolThatMovesAlongZFirst", "T5 M6\nG43 H5 G0 Z3\n", "T5 M6\nD1\nG0 Z3\n",
     "TOOL CALL 5 Z\nL Z+3 FMAX\n"},
    {"FeedBehindATool", "G1 X1 F500\nT5 M6\nG1 X2 F500\n", "G1 X1 F500\nT5 M6\nG1 X2 F500\n",
     "L X+1 F500\nTOOL CALL 5 Z\nL X+2 F500\n"},
    {"Speed", "S4000\nX1\n", "S4000\nX1\n", "TOOL CALL Z S4000\nL X+1 FMAX\n"},
    {"SpindleAndCoolant", "M4\nM8\nM9\nM5\n", "M4\nM8\nM9\nM5\n", "M4\nM8\nM9\nM5\n"},
    {"Stops", "M5\nM9\nM0\nM1\n", "M5\nM9\nM0\nM1\n", "M5\nM9\nM0\nM1\n"},
    {"Comment", "(to the left)\nX-1\n", "; to the left\nX-1\n", "; to the left\nL X-1 FMAX\n"},
};

constexpr ActCase kFirstActs[] = {
    {"WorkOffset", "G54\n", "G54\n", "; G54: its datum is active\n"},
    {"NoLength", "G49\n", "D0\n", "; G49: the length of the tool counts\n"},
    {"LengthNotSaid", "T5 M6\n", "T5 M6\n",
     "TOOL CALL 5 Z\n; no G43: the length of the tool counts\n"},
};

struct Said {
  Language language;
  const char* target;
  std::string text;
};

std::vector<Said> in_all_languages(const ActCase& act, bool first) {
  const auto around = [first](const char* lines, const char* rapid) {
    return first ? lines + std::string(rapid) : rapid + std::string(lines);
  };
  const std::string plain = "G21 G17 G40 G90 G94\n" + around(act.plain, "G0 X0 Y0 Z5\n") + "M30\n";
  const std::string siemens =
      "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\n" + around(act.siemens, "G0 X0 Y0 Z5\n") + "M30\n";
  const std::string klartext =
      as_klartext(around(act.klartext, "L X+0 Y+0 Z+5 R0 FMAX\n") + "M30\n");
  return {{Language::kRs274, "linuxcnc", plain},
          {Language::kSiemens, "siemens", siemens},
          {Language::kKlartext, "heidenhain", klartext}};
}

void expect_the_same_in_all_languages(const ActCase& act, bool first) {
  SCOPED_TRACE(act.name);
  for (const Said& from : in_all_languages(act, first)) {
    for (const Said& to : in_all_languages(act, first)) {
      if (from.language == to.language) continue;
      SCOPED_TRACE(fmt::format("to {} from\n{}", to.target, from.text));
      EXPECT_TRUE(is_proved(from.text, from.language, to.text, to.language));
      // Whether a tool's length counts that no D names is a setting of Siemens controls.
      const bool unsaid = std::string_view(act.name) == "LengthNotSaid" &&
                          from.language == Language::kSiemens && to.language == Language::kRs274;
      const SmoothResult result = smoothed(from.text, ways_to(to.target));
      EXPECT_EQ(result.proved, !unsaid) << testing::PrintToString(told(result, from.text));
      EXPECT_EQ(result.text, unsaid ? "" : to.text);
    }
  }
}

TEST(ConversionWays, SayEachActInEachLanguage) {
  for (const ActCase& act : kActs) expect_the_same_in_all_languages(act, false);
  for (const ActCase& act : kFirstActs) expect_the_same_in_all_languages(act, true);
}

// Two rows of the table are never the same for the proof, in any two languages.
TEST(ConversionWays, ProveNoActAsAnother) {
  for (const ActCase& act : kActs) {
    for (const ActCase& other : kActs) {
      if (&act == &other) continue;
      for (const Said& from : in_all_languages(act, false)) {
        for (const Said& to : in_all_languages(other, false)) {
          if (from.language == to.language) continue;
          // Comments are no acts, but its rapid is one.
          EXPECT_FALSE(is_proved(from.text, from.language, to.text, to.language))
              << act.name << other.name;
        }
      }
    }
  }
}

// --- programs as posts and people write them ----------------------------------------------------

constexpr const char* kKlartextPart =
    "0 BEGIN PGM PART MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 BLK FORM 0.2 X+100 Y+100 Z+0\n"
    "3 * - roughing\n4 TOOL CALL 5 Z S3000\n5 L X+1,5 Y-2 R0 FMAX M13\n6 L Z+2 FMAX\n"
    "7 L Z-1 F200\n8 l x+10 f500\n9 CC X+15 Y-2\n10 C X+20 Y-2 DR-\n11 CR X+25 Y+3 R+5 DR+\n"
    "12 L Z+50 R0 FMAX M9\n13 L X+0 M5\n14 M30\n15 END PGM PART MM\n";

// CR: a quarter counter-clockwise from (20, -2) about (20, 3). M13 is M3 and M8 before the motion,
// M9 and M5 come behind theirs. What does not change is not said, nor offsets of 0.
TEST(ConversionWays, SayAKlartextProgramForLinuxcnc) {
  const SmoothResult result = smoothed(kKlartextPart, ways_to("linuxcnc"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, kKlartextPart));
  EXPECT_EQ(result.text,
            "G21 G17 G40 G90 G94\n(BLK FORM 0.1 Z X+0 Y+0 Z-20)\n"
            "(BLK FORM 0.2 X+100 Y+100 Z+0)\n(- roughing)\nT5 M6\nG43 H5\nS3000 M3\nM8\n"
            "G0 X1.5 Y-2\nZ2\nG1 Z-1 F200\nX10 F500\nG2 X20 I5\nG3 X25 Y3 J5\nG0 Z50\nM9\nG1 X0\n"
            "M5\nM30\n");
}

// The same with points, in capitals, and in the frame of such programs.
TEST(ConversionWays, SayAKlartextProgramForFanuc) {
  const SmoothResult result = smoothed(kKlartextPart, ways_to("fanuc"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, kKlartextPart));
  EXPECT_EQ(result.text,
            "%\nO0001\nG21 G17 G40 G90 G94\n(BLK FORM 0.1 Z X+0 Y+0 Z-20)\n"
            "(BLK FORM 0.2 X+100 Y+100 Z+0)\n(- ROUGHING)\nT5 M6\nG43 H5\nS3000 M3\nM8\n"
            "G0 X1.5 Y-2.\nZ2.\nG1 Z-1. F200.\nX10. F500.\nG2 X20. I5.\nG3 X25. Y3. J5.\n"
            "G0 Z50.\nM9\nG1 X0.\nM5\nM30\n%\n");
}

constexpr const char* kSiemensPart =
    "%_N_PART_MPF\n;$PATH=/_N_WKS_DIR\nN10 G17 G40 G71 G90 G94\nN20 G54\nN30 T5\nN40 M6\n"
    "N50 D1 S3000 M3\nN60 G0 X0 Y0\nN70 Z=5\n; cut\nN80 G1 Z-1 F200\nN90 G64\nN100 X=10 F500\n"
    "N110 G2 X20 Y0 CR=5\nN120 G18 G3 X30 Z4 I=5 K5\nN130 G0 Z50\nN140 M5\nN150 M30\n";

// G18: from (20, -1) in X and Z about (25, 4).. its radius is 5 sqrt 2 at the start, 5 at the end.
TEST(ConversionWays, RefuseAnArcWhoseRadiiDiffer) {
  const SmoothResult result = smoothed(kSiemensPart, ways_to("linuxcnc"));
  EXPECT_FALSE(result.understood);
}

std::string siemens_part() {
  std::string text = kSiemensPart;
  const std::string arc = "N120 G18 G3 X30 Z4 I=5 K5\n";
  // A quarter in G18, counter-clockwise from the tip of Y: from Z to X, about (20, 4) in X and Z.
  return text.replace(text.find(arc), arc.size(), "N120 G18 G3 X15 Z4 I=0 K5\n");
}

TEST(ConversionWays, SayASiemensProgramForHaas) {
  const std::string text = siemens_part();
  const SmoothResult result = smoothed(text, ways_to("haas"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  EXPECT_EQ(result.text,
            "%\nO0001\nG21 G17 G40 G90 G94\nG54\nT5 M6\nG43 H5\nS3000 M3\nG0 X0. Y0.\nZ5.\n(cut)\n"
            "G1 Z-1. F200.\nX10. F500.\nG2 X20. I5.\nG18 G3 X15. Z4. K5.\nG0 Z50.\nM5\nM30\n%\n");
}

TEST(ConversionWays, SayASiemensProgramInKlartext) {
  std::string text = siemens_part();
  text.erase(text.find("N120"), text.find("N130") - text.find("N120"));
  const SmoothResult result = smoothed(text, ways_to("itnc530"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  EXPECT_EQ(result.text,
            as_klartext("; G54: its datum is active\nTOOL CALL 5 Z S3000\nM3\n"
                        "L X+0 Y+0 R0 FMAX\nL Z+5 FMAX\n; cut\nL Z-1 F200\nL X+10 F500\n"
                        "CC X+15 Y+0\nC X+20 Y+0 DR-\nL Z+50 FMAX\nM5\nM30\n"));
}

// 1 inch is 25.4 mm; the program stays in inches, F too.
TEST(ConversionWays, KeepTheInchesOfASiemensProgram) {
  const std::string text =
      "%_N_TEST_MPF\nG700\nG17 G40 G90 G94\nG0 X1 Y0 Z.5\nG1 Z-.125 F12.5\nM30\n";
  const SmoothResult result = smoothed(text, ways_to("linuxcnc"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  EXPECT_EQ(result.text, "G20 G17 G40 G90 G94\nG0 X1 Y0 Z0.5\nG1 Z-0.125 F12.5\nM30\n");
}

// FANUC takes arcs of less than 350 degrees, Mach3 those of a quarter by R: a full turn is two,
// four.
TEST(ConversionWays, CutFullTurnsForControlsThatTakeShorterArcs) {
  const std::string text =
      as_klartext("L X+0 Y+0 Z+5 R0 FMAX\nCC X+10 Y+0\nC X+0 Y+0 DR+ F500\nM30\n");
  const auto said_for = [&](const char* target) {
    const SmoothResult result = smoothed(text, ways_to(target));
    EXPECT_TRUE(result.proved) << testing::PrintToString(told(result, text));
    const std::size_t at = result.text.find("G3");
    return at == std::string::npos ? result.text
                                   : result.text.substr(at, result.text.find("M30") - at);
  };
  EXPECT_EQ(said_for("linuxcnc"), "G3 X0 I10 F500\n");
  EXPECT_EQ(said_for("fanuc"), "G3 X20. I10. F500.\nX0. I-10.\n");
  EXPECT_EQ(said_for("siemens"), "G3 X20 I10 F500\nX0 I-10\n");
  EXPECT_EQ(said_for("mach3"), "G3 X10 Y-10 R10 F500\nX20 Y0 R10\nX10 Y10 R10\nX0 Y0 R10\n");
}

// A quarter of radius 0.05 mm, which FANUC is not given: chords of n equal parts leave it by
// 0.05 (1 - cos(45 deg / n)); 0.0038 mm for 2, 0.0017 for 3, 0.00096 for 4, and its step is 0.001.
TEST(ConversionWays, CutArcsThatAreTooSmallIntoChords) {
  const std::string text =
      as_klartext("L X+0 Y+0 Z+5 R0 FMAX\nCC X+0.05 Y+0\nC X+0.05 Y+0.05 DR- F500\nL X+1\nM30\n");
  const SmoothResult result = smoothed(text, ways_to("fanuc"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  // At 22.5, 45 and 67.5 degrees: 0.05 (1 - cos), 0.05 sin.
  EXPECT_NE(result.text.find("G1 X0.004 Y0.019 F500.\nX0.015 Y0.035\nX0.031 Y0.046\nX0.05 Y0.05\n"),
            std::string::npos)
      << result.text;
}

// FANUC has three decimals.
TEST(ConversionWays, RoundPlacesToTheDecimalsOfTheTarget) {
  const std::string text = as_klartext(
      "TOOL CALL 5 Z\nL X+1.2345 Y+2.0004 FMAX\nL Z+3.3333 FMAX\nL X+0.1114 FMAX\nM30\n");
  const SmoothResult result = smoothed(text, ways_to("fanuc"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  EXPECT_NE(result.text.find("G0 X1.235 Y2.\nZ3.333\nX0.111\n"), std::string::npos) << result.text;
  std::string other = result.text;
  other.replace(other.find("X1.235"), 6, "X1.236");
  EXPECT_FALSE(is_proved(text, Language::kKlartext, other, Language::kRs274));
}

// END PGM without M30, with the spindle off: others need an end, and say where it comes from.
TEST(ConversionWays, EndByEndPgm) {
  const std::string text = as_klartext("M3\nL X+0 Y+0 Z+5 R0 FMAX\nL X+1 F500\nM5\n");
  const SmoothResult result = smoothed(text, ways_to("linuxcnc"));
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  EXPECT_TRUE(result.text.ends_with("M5\n(END PGM)\nM30\n")) << result.text;
  std::string other = result.text;
  other.erase(other.find("(END PGM)\n"), 10);
  EXPECT_FALSE(is_proved(text, Language::kKlartext, other, Language::kRs274));
}

TEST(ConversionWays, LeaveTheBlankAsACommentOnlyWhereTheUserSaysSo) {
  SmoothOptions options = ways_to("fanuc");
  options.allowed = {};
  const SmoothResult refused = smoothed(kKlartextPart, options);
  EXPECT_FALSE(refused.understood);
  const auto errors = told(refused, kKlartextPart);
  ASSERT_EQ(errors.size(), 2U);
  EXPECT_TRUE(errors[0].starts_with("2:1: 1 BLK FORM 0.1 Z X+0 Y+0 Z-20 draws the blank"))
      << errors[0];
  // The proof asks for the comment.
  std::string text = smoothed(kKlartextPart, ways_to("fanuc")).text;
  const std::string blank = "(BLK FORM 0.2 X+100 Y+100 Z+0)\n";
  text.erase(text.find(blank), blank.size());
  EXPECT_FALSE(is_proved(kKlartextPart, Language::kKlartext, text, Language::kRs274));
}

// What a comment of another control cannot hold.
TEST(ConversionWays, SayCommentsSoThatNoControlActsOnThem) {
  const std::string text = as_klartext("L X+0 Y+0 Z+5 R0 FMAX\n; MSG, stop (now)\n; $ 100%\nM30\n");
  EXPECT_NE(smoothed(text, ways_to("linuxcnc")).text.find("(- MSG, stop -now-)\n($ 100%)\n"),
            std::string::npos)
      << smoothed(text, ways_to("linuxcnc")).text;
  EXPECT_NE(smoothed(text, ways_to("grbl")).text.find("\n(- 100-)\n"), std::string::npos);
}

// --- smoothed on the way ------------------------------------------------------------------------

std::string klartext_wave() {
  std::string text = "TOOL CALL 3 Z S12000\nM3\nL X+0 Y+0 Z+5 R0 FMAX\nL Z-1 F300\n";
  bool first = true;
  for (std::string line : wave_lines({})) {
    if (first) line = line.substr(3, line.find(" F") - 3);
    text += "L " + line + (std::exchange(first, false) ? " F2000\n" : "\n");
  }
  return as_klartext(text + "L Z+5 FMAX\nM5\nM30\n");
}

std::string siemens_wave() {
  return "%_N_TEST_MPF\nN10 G710 G17 G40 G90 G94\nT3 M6\nD1\nS12000 M3\nG0 X0 Y0 Z5\nG1 Z-1 "
         "F300\n" +
         joined(wave_lines({}), "\n") + tail();
}

struct WaveWay {
  const char* name;
  std::string (*text)();
  Language from;
  const char* target;
};

class ConvertedWave : public testing::TestWithParam<WaveWay> {};

TEST_P(ConvertedWave, IsSmoothedAndProvedAgainstTheOldProgram) {
  const std::string text = GetParam().text();
  SmoothOptions options = ways_to(GetParam().target);
  options.method = Method::kFair;
  const SmoothResult result = smoothed(text, options);
  ASSERT_TRUE(result.proved) << testing::PrintToString(told(result, text));
  EXPECT_GE(rewritten_runs(result), 1U);
  EXPECT_LT(lines_of(result.text).size(), lines_of(text).size());
  EXPECT_TRUE(is_proved(text, GetParam().from, result.text, options.target->language()));
  for (const RunReport& run : result.runs) {
    if (run.status != RunStatus::kRewritten) continue;
    EXPECT_GE(run.first_line, 5U);
    EXPECT_LE(run.last_line, lines_of(text).size() - 3);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Ways, ConvertedWave,
    testing::Values(WaveWay{"KlartextToFanuc", &klartext_wave, Language::kKlartext, "fanuc"},
                    WaveWay{"KlartextToMach3", &klartext_wave, Language::kKlartext, "mach3"},
                    WaveWay{"SiemensToLinuxcnc", &siemens_wave, Language::kSiemens, "linuxcnc"},
                    WaveWay{"SiemensToKlartext", &siemens_wave, Language::kSiemens, "heidenhain"}),
    [](const auto& test) { return std::string(test.param.name); });

// --- what is refused ----------------------------------------------------------------------------

struct WayRefused {
  const char* name;
  const char* blocks;
  std::vector<std::string> told;  // place and message, without the target
};

void expect_refused(const std::string& text, const char* target, const WayRefused& refused) {
  const SmoothResult result = smoothed(text, ways_to(target));
  EXPECT_FALSE(result.understood) << refused.name;
  EXPECT_EQ(result.text, "") << refused.name;
  std::vector<std::string> expected;
  for (const std::string& each : refused.told) {
    expected.push_back(fmt::format("{} (target {})", each, target));
  }
  EXPECT_EQ(told(result, text), expected) << refused.name;
}

// The blocks begin in line 3, behind two that are certain; the columns count the block number.
TEST(ConversionWays, ListTheBlocksOfKlartextThatCannotBeSaid) {
  const WayRefused kRefused[] = {
      {"Compensation",
       "L X+1 RL F500\nL X+2 R0\n",
       {"3:9: RL moves beside the path by the radius of the tool"}},
      {"Increment",
       "L IX+5 F500\nL X+0 Y+0 F500\n",
       {"3:1: 2 L IX+5 F500 is no block of plain words"}},
      {"Parameter",
       "Q1 = +5\nL X+Q1 F500\nL X+0 F500\n",
       {"3:1: 2 Q1 = +5 is no block of plain words",
        "4:1: 3 L X+Q1 F500 is no block of plain words"}},
      {"Cycle",
       "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nL X+0 Y+0 Z+1 FMAX\n",
       {"3:1: 2 CYCL DEF 7.0 DATUM SHIFT is no block of plain words",
        "4:1: 3 CYCL DEF 7.1 X+10 is no block of plain words"}},
      {"Tangential",
       "L X+5 F500\nCT X+10 Y+10\nL X+0 Y+0 FMAX\n",
       {"3:1: 2 L X+5 F500 is no block of plain words",
        "4:1: 3 CT X+10 Y+10 is no block of plain words"}},
      {"Polar",
       "CC X+0 Y+0\nLP PR+10 PA+30 F500\nL X+0 Y+0 FMAX\n",
       {"4:1: 3 LP PR+10 PA+30 F500 is no block of plain words"}},
      {"Label",
       "LBL 1\nCALL LBL 1 REP 2\nL X+0 Y+0 Z+1 FMAX\n",
       {"3:1: 2 LBL 1 is no block of plain words",
        "4:1: 3 CALL LBL 1 REP 2 is no block of plain words",
        "5:1: 4 L X+0 Y+0 Z+1 FMAX is not understood"}},
      {"ToolDef", "TOOL DEF 5 L+0 R+3\n", {"3:1: 2 TOOL DEF 5 L+0 R+3 is no block of plain words"}},
      {"ToolByName",
       "TOOL CALL \"MILL\" Z S1000\nL X+0 FMAX\n",
       {"3:1: 2 TOOL CALL \"MILL\" Z S1000 is no block of plain words"}},
      {"Oversize",
       "TOOL CALL 5 Z S1000 DL+0.1\nL X+0 FMAX\n",
       {"3:1: 2 TOOL CALL 5 Z S1000 DL+0.1 is no block of plain words"}},
      {"OtherToolAxis",
       "TOOL CALL 5 Y S1000\nL X+0 FMAX\n",
       {"3:1: 2 TOOL CALL 5 Y S1000 is no block of plain words"}},
      {"Function", "M7\n", {"3:3: M7 may mean something else there"}},
      {"FunctionInMotion",
       "L X+1 FMAX M99\nL X+0 FMAX\n",
       {"3:1: 2 L X+1 FMAX M99 is no block of plain words"}},
      {"OtherAxis",
       "L X+1 A+5 F500\nL X+0 Y+0 Z+1 FMAX\n",
       {"3:9: A+5 may mean something else there"}},
      {"StopWithSpindleOn",
       "M3\nM0\n",
       {"4:3: M0 stops spindle and coolant on some controls, and they may be on"}},
      {"FeedOfTheTool",
       "TOOL CALL 1 Z F500\nL X+1\n",
       {"4:1: 3 L X+1 moves at a feed that is not known"}},
      {"Tilted",
       "PLANE SPATIAL SPA+0 SPB+45 SPC+0 STAY\nPLANE RESET STAY\nL X+0 Y+0 Z+1 FMAX\n",
       {"3:1: 2 PLANE SPATIAL SPA+0 SPB+45 SPC+0 STAY is no block of plain words"}},
      {"NoFeed", "TOOL CALL 1 Z\nL X+1\n", {"4:1: 3 L X+1 moves at a feed that is not known"}},
      {"SplineBlock",
       "SPL X+1 ~\n  K3X+0 K2X+0 K1X-1 F500\nL X+0 Y+0 Z+1 FMAX\n",
       {"3:1: 2 SPL X+1 ~ is no block of plain words",
        "4:1:   K3X+0 K2X+0 K1X-1 F500 is no block of plain words"}},
  };
  for (const WayRefused& refused : kRefused) {
    const std::string text =
        as_klartext("L X+0 Y+0 Z+5 R0 FMAX\n" + std::string(refused.blocks) + "M30\n");
    expect_refused(text, "linuxcnc", refused);
    expect_refused(text, "siemens", refused);
  }
}

// What posts write at the beginning to be safe does nothing there.
TEST(ConversionWays, LeaveOutEndsOfWhatNeverBegan) {
  const std::string klartext = as_klartext(
      "PLANE RESET STAY\nTOOL CALL 5 Z S3000 F800\nM3\nL X+0 Y+0 FMAX\nL Z+5 FMAX\nL X+1 "
      "F100\nM30\n");
  const std::string siemens =
      "%_N_TEST_MPF\nG710\nTRAFOOF\nCOMPOF\nDIAMOF\nG17 G40 G90 G94\nT5 M6\nD1\nS3000 M3\n"
      "G0 X0 Y0\nZ5\nG1 X1 F100\nM30\n";
  for (const std::string& text : {klartext, siemens}) {
    const SmoothResult result = smoothed(text, ways_to("linuxcnc"));
    EXPECT_TRUE(result.proved) << testing::PrintToString(told(result, text));
    EXPECT_EQ(result.text,
              "G21 G17 G40 G90 G94\nT5 M6\nG43 H5\nS3000 M3\nG0 X0 Y0\nZ5\nG1 X1 F100\nM30\n");
  }
}

TEST(ConversionWays, RefuseAProgramWithoutAnEnd) {
  const std::string text = "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\nG0 X0 Y0 Z5\n";
  expect_refused(text, "linuxcnc",
                 {"End", "", {"4:1: G0 X0 Y0 Z5 ends the program without M2 or M30"}});
}

TEST(ConversionWays, RefuseKlartextInInches) {
  std::string text = as_klartext("L X+0 Y+0 Z+5 R0 FMAX\nM30\n");
  text.replace(text.find(" MM"), 3, " INCH");
  expect_refused(
      text, "fanuc",
      {"Inch",
       "",
       {"1:1: 0 BEGIN PGM TEST INCH is in inches, where it is not certain what F means"}});
}

TEST(ConversionWays, RefuseAnEndWithTheSpindleOn) {
  expect_refused(as_klartext("M3\nL X+0 Y+0 Z+5 R0 FMAX\n"), "fanuc",
                 {"End",
                  "",
                  {"4:1: 3 END PGM TEST MM ends without M2 or M30, and spindle or coolant may be "
                   "on"}});
}

TEST(ConversionWays, ListTheBlocksOfSiemensProgramsThatCannotBeSaid) {
  const WayRefused kRefused[] = {
      {"Frame",
       "TRANS X10\nG0 X0 Y0 Z5\n",
       {"5:1: TRANS is a word that only Siemens controls have"}},
      {"Compressor",
       "COMPCAD\nCOMPOF\n",
       {"5:1: COMPCAD is a word that only Siemens controls have"}},
      {"Message",
       "MSG(\"hello\")\n",
       {"5:1: MSG(\"hello\") is a word that only Siemens controls have"}},
      {"Cycle",
       "CYCLE832(0.01,1,1)\n",
       {"5:1: CYCLE832(0.01,1,1) is a word that only Siemens controls have"}},
      {"Parameter",
       "R1=5\nX=R1\nX0\n",
       {"5:1: R1=5 is no block of plain words", "6:1: X=R1 is no block of plain words"}},
      {"Increment", "X=IC(5)\nX0\n", {"5:1: X=IC(5) is no block of plain words"}},
      {"Offset", "G505\nG0 X0 Y0 Z5\n", {"5:1: G505 is a word that only Siemens controls have"}},
      {"InchPlacesAlone", "G70\nG0 X0 Y0 Z1\n", {"5:1: G70 leaves feeds in millimetres"}},
      {"ExactStop", "G60\nG64\n", {"5:1: G60 may mean something else there"}},
      {"ToolByName",
       "T=\"MILL\"\nM6\nG0 X0 Y0 Z5\n",
       {"5:1: T=\"MILL\" is no block of plain words", "6:1: M6 names no tool"}},
      {"OtherEdge", "T1 M6\nD2\nG0 X0 Y0\n", {"6:1: D2 is another edge of the tool"}},
      {"EdgeOfNoTool",
       "D1\nG0 X0 Y0 Z5\n",
       {"5:1: D1 names the length of a tool that no M6 has put in"}},
      {"EdgeTooLate",
       "T1 M6\nG0 Z5\nD1\nG0 X0 Y0 Z5\n",
       {"7:1: D1 comes behind a motion without the length of the tool"}},
      {"Jump",
       "GOTOF ENDE\nENDE:\n",
       {"5:1: GOTOF ENDE is no block of plain words", "6:1: ENDE: is jumped to"}},
      {"Subprogram",
       "L100\nG0 X0 Y0 Z5\n",
       {"5:1: L100 is no block of plain words", "6:1: G0 X0 Y0 Z5 is not understood"}},
      {"Helix", "G2 X2 Y0 Z4 I1 J0 F100\nG0 X0\n", {"5:1: G2 X2 Y0 Z4 I1 J0 F100 is a helix"}},
      {"Skipped",
       "/G0 X3\nG0 X0 Y0 Z5\n",
       {"5:1: /G0 X3 is left out by some controls, run by others"}},
      {"SpindleStopInMotion",
       "G0 X5 M5\n",
       {"5:7: M5 acts before or behind the motion of its block: controls differ"}},
      {"Dwell", "G4 F2\n", {"5:1: G4 may mean something else there"}},
  };
  for (const WayRefused& refused : kRefused) {
    const std::string text = "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\nG0 X0 Y0 Z5\n" +
                             std::string(refused.blocks) + "M30\n";
    if (std::string_view(refused.name) != "EdgeTooLate") expect_refused(text, "linuxcnc", refused);
    expect_refused(text, "heidenhain", refused);
  }
}

// Words that a target has not: found by the acts that need them.
TEST(ConversionWays, ListWhatATargetHasNoWordFor) {
  const std::string text = as_klartext("TOOL CALL 5 Z S3000\nL X+0 Y+0 Z+5 R0 FMAX\nM3\nM5\nM30\n");
  expect_refused(text, "grbl",
                 {"Grbl", "", {"2:1: 1 TOOL CALL 5 Z S3000 needs M6, which is not taken there"}});
  expect_refused(text, "okuma",
                 {"Okuma", "", {"2:1: 1 TOOL CALL 5 Z S3000 needs G43, which is not taken there"}});
  const std::string offset =
      as_klartext("; G55: its datum is active\nL X+0 Y+0 Z+5 R0 FMAX\nM30\n");
  expect_refused(
      offset, "okuma",
      {"Okuma", "", {"2:3: ; G55: its datum is active needs G55, which is not taken there"}});
  const std::string moves = as_klartext("L X+0 Y+0 Z+5 R0 FMAX\nM30\n");
  expect_refused(moves, "beckhoff",
                 {"Beckhoff",
                  "",
                  {"2:1: 1 L X+0 Y+0 Z+5 R0 FMAX needs G21, which is mirrors the path on this "
                   "control, whose units are G70 and G71"}});
}

// --- round trips --------------------------------------------------------------------------------

// Lines, arcs, rapids, tools, feeds, speeds and coolant at random, in plain words.
class RandomProgram {
 public:
  explicit RandomProgram(unsigned seed) : random_(seed) {}

  std::string text() {
    std::string text = "G21 G17 G40 G90 G94\n" + tool();
    for (int i = 0; i < 40; ++i) text += block();
    return text + "G0 Z50\nM9\nM5\nM30\n";
  }

 private:
  double number(double low, double high) {
    return std::round(std::uniform_real_distribution<double>(low, high)(random_) * 1000) / 1000;
  }
  int whole(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }

  std::string tool() {
    const int tool = whole(1, 9);
    x_ = number(-50, 50);
    y_ = number(-50, 50);
    return fmt::format("T{} M6\n{}\nS{} M3\nG0 X{} Y{}\nZ{}\nG1 Z-1 F{}\n", tool,
                       whole(0, 3) > 0 ? fmt::format("G43 H{}", tool) : "(as it was)",
                       whole(500, 9000), x_, y_, number(2, 9), whole(100, 900));
  }

  std::string block() {
    switch (whole(0, 9)) {
      case 0:
        return fmt::format("G0 Z{}\n", number(1, 9));
      case 1:
        return fmt::format("F{}\n", whole(100, 900));
      case 2:
        return whole(0, 1) == 0 ? "M8\n" : "M9\n";
      case 3:
        return fmt::format("S{}\n", whole(500, 5000));
      case 4:
      case 5:
        return arc();
      case 6:
        return whole(0, 5) == 0 ? "M5\n" + tool() : "(note)\n";
      default:
        x_ = number(-50, 50);
        y_ = number(-50, 50);
        return fmt::format("G1 X{} Y{}\n", x_, y_);
    }
  }

  // The centre is at (x - radius, y), so that the start stands at the angle 0.
  std::string arc() {
    const double radius = number(2, 20);
    const double angle = number(0.3, 6);
    const bool clockwise = whole(0, 1) == 0;
    const double x = x_ - radius + radius * std::cos(clockwise ? -angle : angle);
    const double y = y_ + radius * std::sin(clockwise ? -angle : angle);
    x_ = std::round(x * 1000) / 1000;
    y_ = std::round(y * 1000) / 1000;
    return fmt::format("G{} X{} Y{} I{} J0\n", clockwise ? 2 : 3, x_, y_, -radius);
  }

  std::mt19937 random_;
  double x_ = 0;
  double y_ = 0;
};

std::vector<std::string> events_of(const std::string& text, Language language) {
  const ReadAs as(text, language);
  const ProgramEvents list = list_common_events(as.read());
  std::vector<std::string> all;
  std::size_t next = 0;
  const auto say_place = [&](std::int32_t motion) {
    const geometry::Point3 end =
        geometry::end_point(as.meaning.motions.at(static_cast<std::size_t>(motion)).piece);
    return fmt::format("{:.3f} {:.3f} {:.3f}", end.x() + 0.0, end.y() + 0.0, end.z() + 0.0);
  };
  for (std::size_t i = 0; i <= list.events.size(); ++i) {
    for (; next < list.cuts_before[i]; ++next) {
      const Cut& cut = list.cuts[next];
      all.push_back(fmt::format("cut to {} at {:g}",
                                say_place(static_cast<std::int32_t>(cut.motion)),
                                cut.feed.value_or(0)));
    }
    if (i == list.events.size()) break;
    const ProgramEvent& event = list.events[i];
    all.push_back(event.kind == EventKind::kRapid ? "rapid to " + say_place(event.motion)
                                                  : event.text);
  }
  return all;
}

// There and back, the same events: tools, speeds, functions, rapids, cuts with their feeds. Places
// have three decimals, so nothing is rounded; arcs of Siemens may be cut in two.
TEST(ConversionWays, ThereAndBackDoTheSame) {
  constexpr unsigned kPrograms = 200;
  for (unsigned seed = 1; seed <= kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::string text = RandomProgram(seed).text();
    for (const char* target : {"heidenhain", "siemens"}) {
      const Language language = gcode::find_dialect(target)->language();
      const SmoothResult there = smoothed(text, ways_to(target));
      ASSERT_TRUE(there.proved) << target << testing::PrintToString(told(there, text)) << text;
      EXPECT_EQ(events_of(there.text, language), events_of(text, Language::kRs274)) << target;
      const bool not_said = text.find("as it was") != std::string::npos;
      const SmoothResult back = smoothed(there.text, ways_to("linuxcnc"));
      if (not_said && language == Language::kSiemens) {
        EXPECT_FALSE(back.understood);
        continue;
      }
      ASSERT_TRUE(back.proved) << target << testing::PrintToString(told(back, there.text));
      EXPECT_EQ(events_of(back.text, Language::kRs274), events_of(text, Language::kRs274));
    }
  }
}

// --- the proof ----------------------------------------------------------------------------------

struct WayDamage {
  const char* name;
  const char* from;
  const char* to;
};

constexpr WayDamage kDamages[] = {
    {"Sense", "G2 X20. I5.", "G3 X20. I5."},
    {"OtherSense", "G3 X25. Y3. J5.", "G2 X25. Y3. J5."},
    {"AbsoluteCentre", "G2 X20. I5.", "G2 X20. I15. J-2."},
    {"CentreBackwards", "J5.", "J-5."},
    {"Feed", "F500.", "F501."},
    {"FeedLost", "X10. F500.", "X10."},
    {"RapidAsCut", "G0 Z50.", "G1 Z50."},
    {"CutAsRapid", "G1 Z-1. F200.", "Z-1. F200."},
    {"Units", "G21", "G20"},
    {"Increments", "G90", "G91"},
    {"Plane", "G17", "G18"},
    {"FeedPerTurn", "G94", "G95"},
    {"SpindleBehindMotion", "S3000 M3\nM8\nG0 X1.5 Y-2.\n", "S3000\nM8\nG0 X1.5 Y-2.\nM3\n"},
    {"CoolantOffEarly", "G0 Z50.\nM9\n", "M9\nG0 Z50.\n"},
    {"StopEarly", "G1 X0.\nM5\n", "M5\nG1 X0.\n"},
    {"Spindle", "M3", "M4"},
    {"CoolantLost", "M8\n", ""},
    {"Speed", "S3000", "S300"},
    {"Tool", "T5", "T6"},
    {"LengthLost", "G43 H5\n", ""},
    {"LengthOfAnother", "G43 H5", "G43 H6"},
    {"LengthOff", "G43 H5", "G49"},
    {"RapidPlace", "Z2.", "Z3."},
    {"Place", "X10. F500.", "X10.02 F500."},
    {"Compensation", "G40", "G41 D1"},
    {"WorkOffset", "T5 M6", "G54\nT5 M6"},
    {"Dwell", "M9\n", "M9\nG4 P1\n"},
    {"Shift", "M9\n", "M9\nG92 X0\n"},
    {"EndLost", "M30\n", ""},
};

TEST(ConversionWays, ProveNoDamagedProgram) {
  const std::string text = smoothed(kKlartextPart, ways_to("fanuc")).text;
  ASSERT_TRUE(is_proved(kKlartextPart, Language::kKlartext, text, Language::kRs274));
  for (const WayDamage& damage : kDamages) {
    std::string damaged = text;
    const std::size_t at = damaged.find(damage.from);
    ASSERT_NE(at, std::string::npos) << damage.name << '\n' << text;
    damaged.replace(at, std::string_view(damage.from).size(), damage.to);
    EXPECT_FALSE(is_proved(kKlartextPart, Language::kKlartext, damaged, Language::kRs274))
        << damage.name;
  }
}

// The same from Siemens words.
TEST(ConversionWays, ProveNoDamagedSiemensProgram) {
  const std::string text = siemens_part();
  const std::string written = smoothed(text, ways_to("haas")).text;
  ASSERT_TRUE(is_proved(text, Language::kSiemens, written, Language::kRs274));
  const WayDamage kOfSiemens[] = {
      {"Units", "G71", "G70"},
      {"Inches", "G71", "G700"},
      {"EdgeLost", "D1 ", ""},
      {"OtherEdge", "D1", "D2"},
      {"NoEdge", "D1", "D0"},
      {"Frame", "N20 G54", "N20 G54 ROT Z10"},
      {"Offset", "G54", "G505"},
      {"Radius", "CR=5", "CR=6"},
      {"Axis", "Z=5", "Z=IC(5)"},
      {"Compressor", "N90 G64", "N90 COMPCAD"},
      {"Rounded", "F500", "F500 RND=2"},
      {"Plane", "G18 G3", "G17 G3"},
  };
  for (const WayDamage& damage : kOfSiemens) {
    std::string other = text;
    const std::size_t at = other.find(damage.from);
    ASSERT_NE(at, std::string::npos) << damage.name;
    other.replace(at, std::string_view(damage.from).size(), damage.to);
    EXPECT_FALSE(is_proved(other, Language::kSiemens, written, Language::kRs274)) << damage.name;
  }
}

}  // namespace
}  // namespace batten::postproc
