// The same acts in three languages, derived by hand: each converted and proved in all six
// directions, none proved as another.
#include <gtest/gtest.h>

#include "tests/support/conversion_programs.h"

namespace batten::postproc {
namespace {

using gcode::Language;

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

std::vector<Said> in_all_languages(const ActCase& operation, bool first) {
  const auto around = [first](const char* lines, const char* rapid) {
    return first ? lines + std::string(rapid) : rapid + std::string(lines);
  };
  const std::string plain =
      "G21 G17 G40 G90 G94\n" + around(operation.plain, "G0 X0 Y0 Z5\n") + "M30\n";
  const std::string siemens = "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\n" +
                              around(operation.siemens, "G0 X0 Y0 Z5\n") + "M30\n";
  const std::string klartext =
      as_klartext(around(operation.klartext, "L X+0 Y+0 Z+5 R0 FMAX\n") + "M30\n");
  return {{Language::kRs274, "linuxcnc", plain},
          {Language::kSiemens, "siemens", siemens},
          {Language::kKlartext, "heidenhain", klartext}};
}

void expect_the_same_in_all_languages(const ActCase& operation, bool first) {
  SCOPED_TRACE(operation.name);
  for (const Said& from : in_all_languages(operation, first)) {
    for (const Said& to : in_all_languages(operation, first)) {
      if (from.language == to.language) continue;
      SCOPED_TRACE(fmt::format("to {} from\n{}", to.target, from.text));
      EXPECT_TRUE(is_proved(from.text, from.language, to.text, to.language));
      // Whether a tool's length counts that no D names is a setting of Siemens controls.
      const bool unsaid = std::string_view(operation.name) == "LengthNotSaid" &&
                          from.language == Language::kSiemens && to.language == Language::kRs274;
      const SmoothResult result = smoothed(from.text, ways_to(to.target));
      EXPECT_EQ(result.proved, !unsaid) << testing::PrintToString(told(result, from.text));
      EXPECT_EQ(result.text, unsaid ? "" : to.text);
    }
  }
}

TEST(ConversionWays, SayEachActInEachLanguage) {
  for (const ActCase& operation : kActs) expect_the_same_in_all_languages(operation, false);
  for (const ActCase& operation : kFirstActs) expect_the_same_in_all_languages(operation, true);
}

// Two rows of the table are never the same for the proof, in any two languages.
TEST(ConversionWays, ProveNoActAsAnother) {
  for (const ActCase& operation : kActs) {
    for (const ActCase& other : kActs) {
      if (&operation == &other) continue;
      for (const Said& from : in_all_languages(operation, false)) {
        for (const Said& to : in_all_languages(other, false)) {
          if (from.language == to.language) continue;
          // Comments are no acts, but its rapid is one.
          EXPECT_FALSE(is_proved(from.text, from.language, to.text, to.language))
              << operation.name << other.name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace batten::postproc
