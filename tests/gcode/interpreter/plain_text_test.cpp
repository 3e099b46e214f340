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
                           "N9XXX (, 2026-11-25 22:46)", "oxxxx", "<PART-1>", "<a_b.1> (left)"}) {
    EXPECT_TRUE(is_title(line)) << line;
  }
  for (const char* line : {"",
                           "PART",
                           "START_PRINT",
                           "START_PRINT BED=60",
                           "TRANS X10 Y5",
                           "ROT RPL 30",
                           "CYCL DEF 7.0",
                           "PLANE RESET STAY",
                           "Call subprogram 5",
                           "MODIN O100",
                           "#RTCP ON",
                           "part X10",
                           "G91 mode on",
                           "TRANS DATUM",
                           "10 L X5",
                           "SET_VELOCITY_LIMIT ACCEL=500",
                           "TOOL CALL 1 Z",
                           "N9X",
                           "N9 XXX",
                           "N9XXXY",
                           "N10X5",
                           "NXX.5",
                           "XXX",
                           "M9XXX"}) {
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
    {"M291 P\"T2\" S3", TextEffect::kPlace},
    {"M0 Change the tool", TextEffect::kPlace},
    {"M01 put in T2", TextEffect::kPlace},
    {"M94/1", TextEffect::kPlace},
    {"N20 m26/Z", TextEffect::kPlace},
    {"M3 $0 S1000", TextEffect::kSpindle},
    {"N5 m5 $-1", TextEffect::kSpindle},
    // More than a switch, and more than a spindle.
    {"M98/1", TextEffect::kAnything},
    {"M30/1", TextEffect::kAnything},
    {"M115/Z P-10 F50", TextEffect::kAnything},
    {"G91/1", TextEffect::kAnything},
    {"G91 M94/1", TextEffect::kAnything},
    {"M94/G2X10", TextEffect::kAnything},
    {"M6 $0", TextEffect::kAnything},
    {"M3 $0 G91", TextEffect::kAnything},
    {"M0 G91 x", TextEffect::kAnything},
    {"M0 $x", TextEffect::kAnything},
    {"M2 Ready", TextEffect::kAnything},
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
    const bool place = row.effect != TextEffect::kPlace;
    EXPECT_EQ(it.read.motions.back().start_known, place);
  }
}

// S of another spindle is no speed of this one.
TEST(TextEffects, OfSpindlesLeaveNoSpeedKnown) {
  const tests::Interpreted it("G21 S1000\nM3 $1 S500\n");
  EXPECT_FALSE(it.last_state().spindle_speed.has_value());
}

TEST(LeadingName, IsWhatALineOfNamesBeginsWith) {
  EXPECT_EQ(leading_name("set_pin PIN=fan VALUE=1"), "SET_PIN");
  EXPECT_EQ(leading_name("#MSG[\"text\"]"), "#MSG");
  EXPECT_EQ(leading_name("msg \"text\" ; more"), "MSG");
  for (const char* line : {"", "X", "M5 x", "#100", "MSG(5)", "MSG=5", "$MSG", "\"MSG\""}) {
    EXPECT_EQ(leading_name(line), "") << line;
  }
}

TEST(LetterName, IsShortAndBeginsWithALetter) {
  for (const char* line : {"NAT01", "na", "NA1 (second tool)"}) {
    EXPECT_TRUE(is_letter_name(line, 'N')) << line;
  }
  for (const char* line : {"N1", "NAT012", "NA 1", "N", "OAB", "NA=1", "NA:"}) {
    EXPECT_FALSE(is_letter_name(line, 'N')) << line;
  }
}

bool named_blocks_do_nothing(const std::string& text) {
  ReadOptions options;
  options.names_blocks = true;
  const tests::Interpreted it(text, options);
  return !it.read.motions.empty() && it.read.motions.back().start_known &&
         is_known(it.last_state());
}

// NAT01 is a name to jump to on Okuma, OPART that of the program.
TEST(LetterName, DoesNothingWhereNothingJumpsToIt) {
  const std::string cuts = std::string(kModesSaid) + kFirstCut;
  EXPECT_FALSE(named_blocks_do_nothing("N1 G0\nOPART\n" + cuts));
  EXPECT_TRUE(named_blocks_do_nothing("%\nOPART (left)\n" + cuts));
  EXPECT_TRUE(named_blocks_do_nothing(cuts + "NAT01\nX2\n"));
  EXPECT_TRUE(named_blocks_do_nothing("N10 G17\n" + cuts + "NAT01\nX2\n")) << "no call";
  EXPECT_FALSE(cuts_are_known(cuts + "NAT01\nX2\n"));
  for (const char* jump : {"GOTO NAT01", "IF [V1 EQ 2] NAT01", "N5 GOTO NAT01"}) {
    EXPECT_FALSE(named_blocks_do_nothing(cuts + "NAT01\nX2\n" + jump + "\n")) << jump;
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
