// Programs converted from each language to each other one, byte for byte, and smoothed on the way.
#include <gtest/gtest.h>

#include "tests/support/conversion_programs.h"

namespace batten::postproc {
namespace {

using gcode::Language;

// --- programs as posts and people write them ----------------------------------------------------

struct WayCase {
  const char* name;
  std::string text;
  const char* target;
  std::string written;
};

std::vector<WayCase> way_cases() {
  std::string without_other_plane = siemens_part();
  const std::size_t arc = without_other_plane.find("N120");
  without_other_plane.erase(arc, without_other_plane.find("N130") - arc);
  return {
      // CR: a quarter counter-clockwise from (20, -2) about (20, 3). M13 is M3 and M8 before the
      // motion, M9 and M5 come after theirs. What does not change is not said, nor offsets of 0.
      {"Klartext", kKlartextPart, "linuxcnc",
       "G21 G17 G40 G90 G94\n(BLK FORM 0.1 Z X+0 Y+0 Z-20)\n(BLK FORM 0.2 X+100 Y+100 Z+0)\n"
       "(- roughing)\nT5 M6\nG43 H5\nS3000 M3\nM8\nG0 X1.5 Y-2\nZ2\nG1 Z-1 F200\nX10 F500\n"
       "G2 X20 I5\nG3 X25 Y3 J5\nG0 Z50\nM9\nG1 X0\nM5\nM30\n"},
      // The same with points, in capitals, and in the frame of such programs.
      {"KlartextInAFrame", kKlartextPart, "fanuc",
       "%\nO0001\nG21 G17 G40 G90 G94\n(BLK FORM 0.1 Z X+0 Y+0 Z-20)\n"
       "(BLK FORM 0.2 X+100 Y+100 Z+0)\n(- ROUGHING)\nT5 M6\nG43 H5\nS3000 M3\nM8\n"
       "G0 X1.5 Y-2.\nZ2.\nG1 Z-1. F200.\nX10. F500.\nG2 X20. I5.\nG3 X25. Y3. J5.\nG0 Z50.\nM9\n"
       "G1 X0.\nM5\nM30\n%\n"},
      {"Siemens", siemens_part(), "haas",
       "%\nO0001\nG21 G17 G40 G90 G94\nG54\nT5 M6\nG43 H5\nS3000 M3\nG0 X0. Y0.\nZ5.\n(cut)\n"
       "G1 Z-1. F200.\nX10. F500.\nG2 X20. I5.\nG18 G3 X15. Z4. K5.\nG0 Z50.\nM5\nM30\n%\n"},
      {"SiemensInKlartext", without_other_plane, "itnc530",
       as_klartext("; G54: its datum is active\nTOOL CALL 5 Z S3000\nM3\nL X+0 Y+0 R0 FMAX\n"
                   "L Z+5 FMAX\n; cut\nL Z-1 F200\nL X+10 F500\nCC X+15 Y+0\nC X+20 Y+0 DR-\n"
                   "L Z+50 FMAX\nM5\nM30\n")},
      // 1 inch is 25.4 mm; the program stays in inches, F too.
      {"Inches", "%_N_TEST_MPF\nG700\nG17 G40 G90 G94\nG0 X1 Y0 Z.5\nG1 Z-.125 F12.5\nM30\n",
       "linuxcnc", "G20 G17 G40 G90 G94\nG0 X1 Y0 Z0.5\nG1 Z-0.125 F12.5\nM30\n"},
      // Whose units are G71 and G70, and whose dwell is X in seconds.
      {"KlartextForBeckhoff",
       as_klartext("L X+0 Y+0 Z+5 R0 FMAX\nCYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 2\n"
                   "L X+10 F500\nM30\n"),
       "beckhoff", "G71 G17 G40 G90 G94\nG0 X0 Y0 Z5\nG4 X2.\nG1 X10 F500\nM30\n"},
      {"InchesForBeckhoff", "%_N_TEST_MPF\nG700\nG17 G40 G90 G94\nG0 X1 Y0 Z.5\nM30\n", "beckhoff",
       "G70 G17 G40 G90 G94\nG0 X1 Y0 Z0.5\nM30\n"},
  };
}

TEST(ConversionWays, SayEachProgramForEachTarget) {
  for (const WayCase& way : way_cases()) {
    EXPECT_EQ(proved_text(way.text, way.target), way.written) << way.name;
  }
  const WayCase inches = way_cases().back();
  EXPECT_FALSE(is_proved(inches.text, Language::kSiemens, replaced(inches.written, "G70", "G71"),
                         Language::kRs274));
}

// G18: from (20, -1) in X and Z about (25, 4).. its radius is 5 sqrt 2 at the start, 5 at the end.
TEST(ConversionWays, RefuseAnArcWhoseRadiiDiffer) {
  EXPECT_FALSE(smoothed(kSiemensPart, ways_to("linuxcnc")).understood);
}

// FANUC takes arcs of less than 350 degrees, Mach3 those of a quarter by R: a full turn is two,
// four.
TEST(ConversionWays, CutFullTurnsForControlsThatTakeShorterArcs) {
  const std::string text =
      as_klartext("L X+0 Y+0 Z+5 R0 FMAX\nCC X+10 Y+0\nC X+0 Y+0 DR+ F500\nM30\n");
  const auto said_for = [&](const char* target) {
    const std::string written = proved_text(text, target);
    const std::size_t at = written.find("G3");
    return at == std::string::npos ? written : written.substr(at, written.find("M30") - at);
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
  const std::string written = proved_text(text, "fanuc");
  // At 22.5, 45 and 67.5 degrees: 0.05 (1 - cos), 0.05 sin.
  EXPECT_NE(written.find("G1 X0.004 Y0.019 F500.\nX0.015 Y0.035\nX0.031 Y0.046\nX0.05 Y0.05\n"),
            std::string::npos)
      << written;
}

// FANUC has three decimals.
TEST(ConversionWays, RoundPlacesToTheDecimalsOfTheTarget) {
  const std::string text = as_klartext(
      "TOOL CALL 5 Z\nL X+1.2345 Y+2.0004 FMAX\nL Z+3.3333 FMAX\nL X+0.1114 FMAX\nM30\n");
  const std::string written = proved_text(text, "fanuc");
  EXPECT_NE(written.find("G0 X1.235 Y2.\nZ3.333\nX0.111\n"), std::string::npos) << written;
  EXPECT_FALSE(is_proved(text, Language::kKlartext, replaced(written, "X1.235", "X1.236"),
                         Language::kRs274));
}

// END PGM without M30, with the spindle off: others need an end, and say where it comes from.
TEST(ConversionWays, EndByEndPgm) {
  const std::string text = as_klartext("M3\nL X+0 Y+0 Z+5 R0 FMAX\nL X+1 F500\nM5\n");
  const std::string written = proved_text(text, "linuxcnc");
  EXPECT_TRUE(written.ends_with("M5\n(END PGM)\nM30\n")) << written;
  EXPECT_FALSE(
      is_proved(text, Language::kKlartext, replaced(written, "(END PGM)\n", ""), Language::kRs274));
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
  const std::string text =
      replaced(proved_text(kKlartextPart, "fanuc"), "(BLK FORM 0.2 X+100 Y+100 Z+0)\n", "");
  EXPECT_FALSE(is_proved(kKlartextPart, Language::kKlartext, text, Language::kRs274));
}

// What a comment of another control cannot hold.
TEST(ConversionWays, SayCommentsSoThatNoControlActsOnThem) {
  const std::string text = as_klartext("L X+0 Y+0 Z+5 R0 FMAX\n; MSG, stop (now)\n; $ 100%\nM30\n");
  const std::string written = proved_text(text, "linuxcnc");
  EXPECT_NE(written.find("(- MSG, stop -now-)\n($ 100%)\n"), std::string::npos) << written;
  EXPECT_NE(proved_text(text, "grbl").find("\n(- 100-)\n"), std::string::npos);
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
