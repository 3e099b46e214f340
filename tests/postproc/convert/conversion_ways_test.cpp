// Programs converted from each language to each other one, byte for byte, and smoothed on the way.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>

#include "tests/support/conversion_programs.h"

namespace batten::postproc {
namespace {

using gcode::Language;

// --- programs as posts and people write them ----------------------------------------------------

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

// G18: from (20, -1) in X and Z about (25, 4).. its radius is 5 sqrt 2 at the start, 5 at the end.
TEST(ConversionWays, RefuseAnArcWhoseRadiiDiffer) {
  const SmoothResult result = smoothed(kSiemensPart, ways_to("linuxcnc"));
  EXPECT_FALSE(result.understood);
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

// Whose units are G71 and G70, and whose dwell is X in seconds.
TEST(ConversionWays, SayProgramsForBeckhoff) {
  const std::string klartext = as_klartext(
      "L X+0 Y+0 Z+5 R0 FMAX\nCYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 2\nL X+10 F500\nM30\n");
  const SmoothResult in_mm = smoothed(klartext, ways_to("beckhoff"));
  ASSERT_TRUE(in_mm.proved) << testing::PrintToString(told(in_mm, klartext));
  EXPECT_EQ(in_mm.text, "G71 G17 G40 G90 G94\nG0 X0 Y0 Z5\nG4 X2.\nG1 X10 F500\nM30\n");
  const std::string siemens = "%_N_TEST_MPF\nG700\nG17 G40 G90 G94\nG0 X1 Y0 Z.5\nM30\n";
  const SmoothResult in_inches = smoothed(siemens, ways_to("beckhoff"));
  ASSERT_TRUE(in_inches.proved) << testing::PrintToString(told(in_inches, siemens));
  EXPECT_EQ(in_inches.text, "G70 G17 G40 G90 G94\nG0 X1 Y0 Z0.5\nM30\n");
  std::string other = in_inches.text;
  other.replace(other.find("G70"), 3, "G71");
  EXPECT_FALSE(is_proved(siemens, Language::kSiemens, other, Language::kRs274));
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
  EXPECT_TRUE(is_proved(text, GetParam().from, result.text, options.target->language));
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

}  // namespace
}  // namespace batten::postproc
