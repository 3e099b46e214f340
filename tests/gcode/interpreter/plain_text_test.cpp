#include "gcode/interpreter/plain_text.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

TEST(PlainText, IsAFileNameOrInBrackets) {
  for (const char* line : {"part.nc", "fanuc.nc (FREECAD-FILENAME-GOES-HERE, JOB)", "wing-3_a.NGC",
                           "[ROUGHING WITH T1]", " [ ] ", "plate.tap ; left"}) {
    EXPECT_TRUE(is_plain_text(line)) << line;
  }
  for (const char* line : {"", "X1.NC", "P100.NC", "part.exe", "part.nc X10", "part.nc part.nc",
                           "[1] [2]", "[#1=2] G91", "TRANS", "START_PRINT", "CALL PGM part.h",
                           "a.nc", "plate.mpf", "pocket.SPF", "$32=1", "run=part.nc"}) {
    EXPECT_FALSE(is_plain_text(line)) << line;
  }
}

TEST(Title, IsWordsThatNoControlTakesForACommand) {
  for (const char* line : {"PART NUMBER 12345", "Bracket left side", "Mold insert rev. 2 (old)",
                           "N9XXX (, 2026-11-25 22:46)", "oxxxx"}) {
    EXPECT_TRUE(is_title(line)) << line;
  }
  for (const char* line : {"", "PART", "START_PRINT", "START_PRINT BED=60", "TRANS X10 Y5",
                           "ROT RPL 30", "CYCL DEF 7.0", "PLANE RESET STAY", "Call subprogram 5",
                           "MODIN O100", "#RTCP ON", "part X10", "G91 mode on", "TRANS DATUM",
                           "10 L X5", "SET_VELOCITY_LIMIT ACCEL=500", "TOOL CALL 1 Z",
                           "N9X", "N9 XXX", "N9XXXY", "N10X5", "NXX.5", "XXX", "M9XXX"}) {
    EXPECT_FALSE(is_title(line)) << line;
  }
}

// N10 is then no target of a call of XXX as Sinumerik would make it.
TEST(OpenNumber, LeavesWhatIsKnownAtTheBeginning) {
  const std::string cuts = "N1 G21 G17 G90\nN2 G0 X0 Y0 Z0\nN3 G1 X1 F100\nN4 X2\n";
  const tests::Interpreted open("N9XXX (the number)\n" + cuts);
  EXPECT_TRUE(is_known(open.last_state()));
  const tests::Interpreted call("N9 PROBE\n" + cuts);
  EXPECT_FALSE(is_known(call.last_state()));
}

constexpr const char* kModesSaid = "G17 G21 G90 G40\n";
constexpr const char* kFirstCut = "G0 X0 Y0 Z5\nG1 Z0 F100\nX1\n";

bool cuts_are_known(const std::string& text) {
  const tests::Interpreted it(text);
  return !it.read.motions.empty() && it.read.motions.back().start_known &&
         is_known(it.last_state());
}

// Behind the first motion a file name may be a call.
TEST(PlainText, TakesNothingAwayBeforeTheFirstMotion) {
  for (const char* line : {"part.nc (X)", "[#1=2]"}) {
    EXPECT_TRUE(cuts_are_known(std::string(kModesSaid) + line + "\n" + kFirstCut)) << line;
    EXPECT_FALSE(cuts_are_known(std::string(kModesSaid) + kFirstCut + line + "\nX3 Y2\nX4\n"))
        << line;
  }
}

struct EffectRow {
  const char* line;
  TextEffect effect;
};

const EffectRow kEffectRows[] = {
    {"[ROUGHING]", TextEffect::kNothing},
    {"$X", TextEffect::kNothing},
    {"$$ (all of them)", TextEffect::kNothing},
    {"$g", TextEffect::kNothing},
    {"$110=500.5", TextEffect::kNothing},
    {"$H", TextEffect::kPlace},
    {"$hz", TextEffect::kPlace},
    {"M117 Layer 3/10", TextEffect::kPlace},
    // What these could be: a line that grbl runs at each start, a jog that moves, a switch of the
    // coordinates, another channel, a macro, a setting of another language, an assignment.
    {"$N0=G91", TextEffect::kAnything},
    {"$J=G91 X10 F100", TextEffect::kAnything},
    {"$RST=#", TextEffect::kAnything},
    {"$1", TextEffect::kAnything},
    {"$P_UIFR[1]=5", TextEffect::kAnything},
    {"$IF V.P.A", TextEffect::kAnything},
    {"$110=G91", TextEffect::kAnything},
    {"[#1=2]", TextEffect::kAnything},
    {"[ROUGHING] G91", TextEffect::kAnything},
    {"START_PRINT", TextEffect::kAnything},
    {"TRANS X10", TextEffect::kAnything},
    {"M1170 x", TextEffect::kAnything},
    {"", TextEffect::kAnything},
};

TEST(TextEffects, AreBoundedByWhatTheLineSays) {
  for (const EffectRow& row : kEffectRows) {
    EXPECT_EQ(text_effect(row.line), row.effect) << row.line;
  }
}

TEST(TextEffects, LeaveModesAsTheyWereAnywhere) {
  for (const EffectRow& row : kEffectRows) {
    if (*row.line == '\0') continue;
    SCOPED_TRACE(row.line);
    const tests::Interpreted it(std::string(kModesSaid) + kFirstCut + row.line + "\nG1 X3 F200\n");
    EXPECT_EQ(is_known(it.last_state()), row.effect != TextEffect::kAnything);
    if (row.effect == TextEffect::kAnything) continue;
    const bool place = row.effect == TextEffect::kNothing;
    EXPECT_EQ(it.read.motions.back().start_known, place);
  }
}

TEST(Title, TakesNothingAwayInFrontOfAllWords) {
  const std::string program = std::string(kModesSaid) + kFirstCut;
  EXPECT_TRUE(cuts_are_known("%\nO1000\n(a)\nBracket left side\nsecond setup\n" + program));
  // Behind words it may be a macro's that moves the origin or sets G91.
  EXPECT_FALSE(cuts_are_known(std::string(kModesSaid) + "Bracket left side\n" + kFirstCut));
  for (const char* command : {"TRANS X10 Y5", "START_PRINT", "PLANE RESET STAY", "#RTCP ON"}) {
    EXPECT_FALSE(cuts_are_known(std::string(command) + "\nG21\n" + kFirstCut)) << command;
  }
}

}  // namespace
}  // namespace batten::gcode
