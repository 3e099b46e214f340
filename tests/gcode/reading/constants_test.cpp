// Expressions of variables: numbers where their value is certain, and nowhere else.
#include "gcode/reading/constants.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/state/reason.h"

namespace batten::gcode {
namespace {

struct WithConstants {
  explicit WithConstants(const std::string& text, const Reading& reading = {})
      : program(parse(SourceText("test.ngc", text), reading, found)),
        meaning(interpret(program, {}, found)) {}

  // The last X.
  [[nodiscard]] const Word& x() const {
    const Word* last = nullptr;
    for (const Word& each : program.words) {
      if (each.letter == 'X') last = &each;
    }
    return *last;
  }

  Diagnostics found;
  Program program;
  Interpretation meaning;
};

struct ValueRow {
  const char* text;
  double value;
  int decimals;
};

const ValueRow kCertain[] = {
    {"#1=5\nG1 X#1", 5, 0},
    {"#1=5.250\nG1 X-#1", -5.25, 2},
    {"# 1 = 5 (a comment = #2)\nG1 X # 1", 5, 0},
    {"N10 #1=5\nG1 X[#1]", 5, 0},
    {"#<scale> = 1.0\nG1X[#<scale>*-27.372]", -27.372, 3},
    {"#<X Scale>=2\nG1 X#<xscale>", 2, 0},
    {"#1=2\n#2=[#1+1]*3\nG1 X[#2-1/4]", 8.75, 2},
    {"#1=2\nG1 X[1+2*3-#1/4*2]", 1 + 2 * 3 - 2.0 / 4 * 2, 0},  // 6: from left to right
    {"#1=2\nG1 X[10-#1-3]", 5, 0},
    {"#1=2\nG1 X-[#1--3]", -5, 0},
    {"#1=3\nG1 X[1/#1]", 1.0 / 3, 6},
    {"#1=1\n#1=[#1+1]\nG1 X#1", 2, 0},
    {"#1=0\nG1 X-#1", 0, 0},
    {"#1=5\nS#1 M3\nG1 X#1", 5, 0},
    {"%\n#1=5\nG1 X#1\n%", 5, 0},
    {"#<d>=5\nT1 M6\nG1 X#<d>", 5, 0},
    {"#<d>=5\n#<_global>=6\n#5221=1\nG1 X#<d>", 5, 0},
    {"#1=5 #2=6\nG1 X[#1+#2]", 11, 0},
    {"(MSG, #1)\n#1=5\n(DEBUG, #1)\nG1 X#1", 5, 0},
    {"GOTO 20\nN10 #1=5\nG1 X#1\nN20 M2", 5, 0},
};

TEST(Constants, AreNumbersOfTheValueThatTheControlFinds) {
  for (const ValueRow& row : kCertain) {
    SCOPED_TRACE(row.text);
    const WithConstants read(row.text);
    ASSERT_TRUE(read.x().is_number);
    EXPECT_TRUE(read.x().computed);
    EXPECT_EQ(read.x().value, row.value);  // doubles in the order of the text
    EXPECT_FALSE(std::signbit(read.x().value) && read.x().value == 0);
    EXPECT_EQ(read.x().decimals, row.decimals);
  }
}

// Each of them would cut elsewhere if the value that was assigned were taken.
const char* const kUncertain[] = {
    "G1 X#1",                                              // what a caller left in it
    "#1=#2\nG1 X#1",                                       // the same
    "#1=5\n#1=#2\nG1 X#1",                                 //
    "#1=5\nN10 G1 X#1\n#1=[#1+1]\nGOTO 10",                // another value each time
    "#1=5\nN10 #1=[#1+1]\nG1 X#1\nIF [#1 LT 9] GOTO 10",   //
    "#1=5\nN10 G1 X#1\n#1=6\nGOTO #2",                     // to any label
    "#1=5\nWHILE [#1 LT 9] DO1\n#1=[#1+1]\nG1 X#1\nEND1",  //
    "#1=5\nWHILE [#2 LT 9] DO1\n#1=6\nEND1\nG1 X#1",       //
    "#1=5\no1 repeat [3]\n#1=6\no1 endrepeat\nG1 X#1",     //
    "#1=5\no1 if [#2 GT 1]\n#1=6\no1 endif\nG1 X#1",       //
    "#1=5\nIF [#2 GT 1] THEN #1=6\nG1 X#1",                //
    "o100 sub\n#1=5\nG1 X#1\no100 endsub",                 // entered when, and in which state?
    "O1\n#1=5\nG1 X#1\nM99",                               //
    "#1=5\no<other> call\nG1 X#1",                         //
    "#1=5\nM98 P100\nG1 X#1",                              // shares local variables with us
    "#1=5\nG65 P100\nG1 X#1",                              //
    "#1=5\nM97 P100\nG1 X#1",                              //
    "#1=5\nM6 T1\nG1 X#1",                                 // a tool changer's macro
    "#1=5\nT1\nG1 X#1",                                    // the same, where T changes the tool
    "#1=5\nM21\nG1 X#1",                                   // a builder's
    "#1=5\nM101\nG1 X#1",                                  // the user's
    "#1=5\nG123\nG1 X#1",                                  //
    "G66 P100\n#100=5\nX1\nG1 X#100",                      // each motion calls
    "#1=5\nMY_MACRO(1)\nG1 X#1",                           //
    "#1=5\n(PY, x=1)\nG1 X#1",                             //
    "#1=5\n;py,x=1\nG1 X#1",                               //
    "#1=5\n%\nG1 X#1",                                     // before the program begins
    "/#1=5\nG1 X#1",                                       // the operator decides
    "#1=5\n/#1=6\nG1 X#1",                                 //
    "#5221=5\nG1 X#5221",                                  // a window into the control
    "#1000=5\nG1 X#1000",                                  // signals of the machine
    "#<_cut>=5\nG1 X#<_cut>",                              // anybody may set it
    "#1=5\n##1=6\nG1 X#5",                                 // which one is set?
    "#2=5\n#[#1]=6\nG1 X#2",                               //
    "#1=5\nG1 X##1",                                       //
    "#1=5\nG1 X#[1]",                                      //
    "#1=5\nG1 X#1.0",                                      //
    "#1=5\nG1 XSIN[#1]",                                   // digits of its own on each control
    "#1=5\nG1 X[#1**2]",                                   //
    "#1=5\nG1 X[#1 MOD 2]",                                //
    "#1=5\nG1 X[#1/0]",                                    //
    "#1=5\nG1 X[#1/[#1-5]]",                               //
    "#1=5 #2=#1\nG1 X#2",                                  // the old #1 or the new one
    "#1=SIN[30] #2=6\n#2=5 #3=COS[1] #2=7\nG1 X#2",        //
    "#1=900000000\nG1 X[#1*2]",                            // no control reads it
};

TEST(Constants, AreNoneWhereTheValueIsNotCertain) {
  for (const char* text : kUncertain) {
    SCOPED_TRACE(text);
    EXPECT_FALSE(WithConstants(text).x().is_number);
  }
}

struct LanguageRow {
  Language language;
  const char* text;
  std::optional<double> value;
};

constexpr auto kSinumerik = Language::kSiemens;
constexpr auto kHeidenhain = Language::kKlartext;

const LanguageRow kOtherLanguages[] = {
    {kSinumerik, "R2=111.2\nG1 X=R2", 111.2},
    {kSinumerik, "N5 R1=5 R2=6\nG1 X=-(R1+R2)*2", -22},
    {kSinumerik, "DEF REAL TOP=143.35, LOW=2\nG1 X=TOP+LOW*10 Y3", 163.35},
    {kSinumerik, "DEF REAL TOP=5\nTOP=6\nG642\nG1 X=TOP", 6},
    {kSinumerik, "DEF REAL TOP=5\nT1 M6\nG1 X=top", 5},
    {kSinumerik, "DEF REAL _TOP=5\nG1 X=_top", 5},
    {kSinumerik, "DEF REAL _A, _B\nN20 _B=5\nG60 FNORM\nT=\"B6\"\nM6\nD1\nG1 X=_B+1", 6},
    {kSinumerik, "DEF REAL TOP=5\nCYCLE81(5,0,1,-3)\nSUPA G0 Z0 D0\nG1 X=TOP", 5},
    {kSinumerik, "R2=5\nCYCLE81(5,0,1,-3)\nG1 X=R2", {}},
    {kSinumerik, "DEF REAL TOP\nTOP=R5\nG1 X=TOP", {}},
    {kSinumerik, "DEF REAL TOP=5\nOTHER=6\nG1 X=TOP", {}},
    {kSinumerik, "R2=5\nT1\nM6\nG1 X=R2", {}},
    {kSinumerik, "R2=5\nL54\nG1 X=R2", {}},
    {kSinumerik, "R2=5\nPOCKET(1)\nG1 X=R2", {}},
    {kSinumerik, "DEF REAL TOP=5\nPOCKET(TOP)\nG1 X=TOP", {}},
    {kSinumerik, "R1=5 R2=R1\nG1 X=R2", {}},
    {kSinumerik, "R1=5\nNEXT: G1 X=R1\nR1=6\nGOTOB NEXT", {}},
    {kSinumerik, "R1=5\nFOR R1=1 TO 5\nG1 X=R1\nENDFOR", {}},
    {kSinumerik, "R1=5\nIF R2>5\nR1=6\nENDIF\nG1 X=R1", {}},
    {kSinumerik, "/R1=5\nG1 X=R1", {}},
    {kSinumerik, "R1=5\nG1 X=SIN(R1)", {}},
    {kSinumerik, "R1=5\nG1 X=IC(R1)", {}},
    {kSinumerik, "R1=5\nG1 X=R[1]", {}},
    {kSinumerik, "DEF INT N=5\nG1 X=N", {}},
    {kSinumerik, "DEF REAL A[2]\nR1=5\nG1 X=A", {}},
    {kSinumerik, "G1 X=$P_UIFR", {}},
    {kHeidenhain, "Q5 = +12\nL X+Q5 R0 F100", 12},
    {kHeidenhain, "FN 0: Q5 = -1,5\nL X-Q5", 1.5},
    {kHeidenhain, "1 Q5 = 2 * ( Q6 + 1 )\n2 L XQ5", {}},
    {kHeidenhain, "1 Q6 = 3\n2 Q5 = 2 * ( Q6 + 1 ) ; twice\n3 L XQ5", 8},
    {kHeidenhain, "QL5 = 7\nTOOL CALL 2 Z\nL XQL5", {}},
    {kHeidenhain, "Q5 = 7\nCALL LBL 1\nL XQ5", {}},
    {kHeidenhain, "Q5 = 7\nCALL PGM part.h\nL XQ5", {}},
    {kHeidenhain, "Q5 = 7\nLBL 1\nQ5 = Q5 + 1\nL XQ5\nCALL LBL 1 REP5", {}},
    {kHeidenhain, "Q5 = 7\nFN 9: IF +Q1 EQU +Q3 GOTO LBL 1\nQ5 = 8\nLBL 1\nL XQ5", {}},
    {kHeidenhain, "Q113 = 7\nL XQ113", {}},
    {kHeidenhain, "Q5 = SIN 30\nL XQ5", {}},
    {kHeidenhain, "Q5 = 7\nQR5 = 8\nL XQR5", {}},
    {kHeidenhain, "Q5 = 7\nCYCL CALL\nL XQ5", {}},
};

TEST(Constants, OfOtherLanguagesAreNumbersOnlyWhereTheyAreCertain) {
  for (const LanguageRow& row : kOtherLanguages) {
    std::string text = row.text;
    if (row.language == kHeidenhain) text = "BEGIN PGM A MM\n" + text + "\nEND PGM A MM\n";
    SCOPED_TRACE(text);
    const WithConstants read(text, {.language = row.language});
    EXPECT_EQ(read.x().is_number, row.value.has_value());
    if (row.value) {
      EXPECT_EQ(read.x().value, *row.value);
    }
  }
}

// The move stops short of the place that its number names.
TEST(Constants, OfKlartextLeaveRoundedCornersAlone) {
  const WithConstants read(
      "BEGIN PGM A MM\nL X+0 Y+0 Z+0 R0 FMAX\nQ5 = 7\nL XQ5 F100\nRND R2\nL Y5\nEND PGM A MM\n",
      {.language = kHeidenhain});
  EXPECT_EQ(read.program.blocks[3].opacity, ParseStatus::kCornerWord);
  EXPECT_LT(read.meaning.blocks[3].motion, 0);
}

TEST(Constants, OfAControlThatMayCountIncrementsNeedPoints) {
  const Reading fanuc{.decimals = {.pointless = PointlessNumbers::kUndeclared}};
  EXPECT_FALSE(WithConstants("#1=5\nG1 X#1", fanuc).x().is_number);
  EXPECT_FALSE(WithConstants("#1=5.\nG1 X[#1*2]", fanuc).x().is_number);
  EXPECT_TRUE(WithConstants("#1=5.\nG1 X[#1*2.]", fanuc).x().is_number);
  // No expression: what it means is asked for.
  EXPECT_FALSE(WithConstants("#1=5.\nG1 X5 Y#1", fanuc).x().is_number);
}

TEST(Constants, AreLeftToWhoTurnsThem) {
  const WithConstants read("G21\n#1=5.\nG1 X#1 F100", {.keeps_expressions = true});
  EXPECT_FALSE(read.x().is_number);
  EXPECT_EQ(read.meaning.blocks.back().barrier, reason::kExpression);
}

TEST(Constants, MakeABlockOfNumbersOnlyWhereEachOfItsWordsIsOne) {
  const WithConstants both("#1=5\nG0 X0 Y0 Z0\nG1 X#1 Y[#1*2] F[#1*100]");
  EXPECT_EQ(both.program.blocks.back().opacity, ParseStatus::kNone);
  ASSERT_EQ(both.meaning.blocks.back().motion, 1);
  EXPECT_EQ(both.meaning.motions[1].piece.end(), geometry::Point3(5, 10, 0));
  EXPECT_EQ(both.meaning.states.back().feed, 500);
  const WithConstants one("#1=5\nG0 X0 Y0 Z0\nG1 X#1 Y#2 F100");
  EXPECT_EQ(one.program.blocks.back().opacity, ParseStatus::kExpression);
  EXPECT_LT(one.meaning.blocks.back().motion, 0);
  // Which tool, which offset, which block: the control is asked.
  const WithConstants others("#1=5\nG43 H#1 X#1");
  EXPECT_EQ(others.program.blocks.back().opacity, ParseStatus::kExpression);
}

}  // namespace
}  // namespace batten::gcode
