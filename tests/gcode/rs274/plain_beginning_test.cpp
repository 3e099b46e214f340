#include <gtest/gtest.h>

#include <string>

#include "gcode/reading/source_kind.h"
#include "gcode/rs274/plain_words.h"

namespace batten::gcode {
namespace {

// What stands there; "none".
std::string beginning_of(const std::string& text) {
  const SourceText source("test", text);
  const auto found = plain_beginning(source);
  return found ? std::string(source.text(*found)) : "none";
}

TEST(PlainBeginning, IsAGWordInTheFirstBlockThatSaysAnything) {
  EXPECT_EQ(beginning_of("G21 G90\n"), "G21 G90");
  EXPECT_EQ(beginning_of("%\nO0001 (part)\n\n; text\n(text)\n  n10 g0 X1\nL X+1\n"), "n10 g0 X1");
  EXPECT_EQ(beginning_of("\xEF\xBB\xBFG21\n"), "G21");
  EXPECT_EQ(beginning_of("O100\r\nN5G21\r\n"), "N5G21");
}

TEST(PlainBeginning, IsNoneOfWhatKlartextMayBeginWith) {
  for (const char* text : {"", "\n", "; text\n", "0 BEGIN PGM A MM\n", "5 L X+1\nG21\n",
                           "L X+1 R0 FMAX\n", "* - part\nL X+1\n", "TOOL CALL 5 Z\n", "CC X+0\n",
                           "M3\n", "5 M3\n", "X1 Y1\n", "GOTO\n", "O100 sub\nG21\n", "N\n"}) {
    EXPECT_EQ(beginning_of(text), "none") << text;
  }
}

// A text without marks is Klartext for a target that reads it, unless it begins so.
TEST(PlainBeginning, DecidesForTargetsThatReadKlartext) {
  const auto language = [](const char* text, SourceKind kind, Language target) {
    Diagnostics found;
    return source_language(SourceText("test", text), kind, target, found);
  };
  EXPECT_EQ(language("G21\n", SourceKind::kAuto, Language::kKlartext), Language::kRs274);
  EXPECT_EQ(language("L X+1\n", SourceKind::kAuto, Language::kKlartext), Language::kKlartext);
  EXPECT_EQ(language("G21\n", SourceKind::kHeidenhain, Language::kKlartext), Language::kKlartext);
  EXPECT_EQ(language("0 BEGIN PGM A MM\n", SourceKind::kAuto, Language::kRs274),
            Language::kKlartext);
}

// A text without marks is for a Siemens control where that is the target and it says such names.
// What Batten writes for one into plain words says nothing of them.
TEST(SiemensNames, DecideForTargetsThatReadThem) {
  const auto language = [](const std::string& text, Language target) {
    Diagnostics found;
    return source_language(SourceText("test", text), SourceKind::kAuto, target, found);
  };
  for (const char* line :
       {"N10 G40 G17 G710 G94 G90 G60 G601 FNORM", "TRANS X10", "MSG(\"face\")", "cycle832(0.01)",
        "G2 X1 Y1 CR=5", "X=IC(5)", "N20 MSG (\"x\") ; y", "T=\"BALL\" SUPA D1", "G642",
        "N5 G0 g500 X1", "G64G601", "T=\"MILL 6\""}) {
    const std::string text = "G90\nG1 X1 F100\n" + std::string(line) + "\nX2\n";
    EXPECT_EQ(language(text, Language::kSiemens), Language::kSiemens) << line;
    EXPECT_EQ(language(text, Language::kRs274), Language::kRs274) << line;
  }
  for (const char* line :
       {"(MSG, TRANS X10)", "; TRANS X10", "G1X1Y2Z3F100", "POLY X1 PO[X]=(1,2,3) F900",
        "BSPLINE SD=3 X1 PL=2", "X1 PW=2", "#<trans>=5", "O100 CALL", "IF [#1 EQ 2] GOTO 10",
        "G6421", "G64.2", "G154 P1", "G510", "(G642)", "#<t>=5", "X642 G64"}) {
    const std::string text = "G90\nG1 X1 F100\n" + std::string(line) + "\nX2\n";
    EXPECT_EQ(language(text, Language::kSiemens), Language::kRs274) << line;
  }
}

}  // namespace
}  // namespace batten::gcode
