#include "gcode/reading/parser.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "gcode/interpreter/interpreter.h"
#include "gcode/siemens/lexer.h"
#include "gcode/siemens/names.h"
#include "gcode/state/reason.h"
#include "gcode/text/number_format.h"
#include "tests/fuzz/parse_promises.h"

namespace batten::gcode {
namespace {

Program siemens(const std::string& text, Diagnostics& found) {
  return parse(SourceText("part.mpf", text), Language::kSiemens, found);
}

// "X10 R5" for the words with plain numbers, "X?" for others.
std::string words_of(const Program& program) {
  std::string text;
  for (const Word& word : program.words) {
    if (!text.empty()) text += ' ';
    text.push_back(word.letter);
    text += word.is_number ? to_text(word.value, NumberFormat{.decimals = 3}) : "?";
  }
  return text;
}

struct LineCase {
  const char* line;
  ParseStatus opacity;
  const char* words;
};

const LineCase kSiemensLineRows[] = {
    {"N10 G1 X10 Y-2.5 F1000", ParseStatus::kNone, "N10 G1 X10 Y-2.5 F1000"},
    {"N10G1X10Y.5", ParseStatus::kNone, "N10 G1 X10 Y0.5"},
    {"G1 X=10 Y = -.5", ParseStatus::kNone, "G1 X10 Y-0.5"},
    {"g1 x1 ; text", ParseStatus::kNone, "G1 X1"},
    {"G2 X10 Y0 CR=5", ParseStatus::kNone, "G2 X10 Y0 R5"},
    {"G3 X10 CR=-5.5", ParseStatus::kNone, "G3 X10 R-5.5"},
    {"G3 X10 CR=R1*2", ParseStatus::kExpression, "G3 X10 R?"},
    {"G2 X1 Y1 I=AC(5) J=AC(3)", ParseStatus::kExpression, "G2 X1 Y1 I? J?"},
    {"G1 X=IC(5) Y3", ParseStatus::kExpression, "G1 X? Y3"},
    {"X=R1 Y=R2+3*SIN(R3) Z1", ParseStatus::kExpression, "X? Y? Z1"},
    {"N10 R1=5 R2=R1*2", ParseStatus::kAssignment, "N10"},
    {"G1 X10 R1=5", ParseStatus::kNamedWords, "G1 X10"},
    {"MSG(\"a ; b ) X1\")", ParseStatus::kNamedWords, ""},
    {"N5 CYCLE832(0.01,_FINISH,1)", ParseStatus::kNamedWords, "N5"},
    {"G90 G94 G642 SOFT FFWON COMPOF", ParseStatus::kNamedWords, "G90 G94"},
    {"G71 G90 X1", ParseStatus::kNamedWords, "G90 X1"},
    {"M1=3 S1=5000", ParseStatus::kNamedWords, ""},
    {"G1 X1=10", ParseStatus::kNamedWords, "G1"},
    {"D1", ParseStatus::kNamedWords, "D1"},
    {"T=\"MILL 6\" M6", ParseStatus::kExpression, "T? M6"},
    {"POLY PO[X]=(18,-18,6) PO[Y]=(6.4)", ParseStatus::kNamedWords, ""},
    {"DEF REAL A, B = 5", ParseStatus::kNamedWords, ""},
    {"N10 GOTOF END_OF_IT", ParseStatus::kFlow, "N10"},
    {"IF R1 == 5 GOTOB N100", ParseStatus::kFlow, ""},
    {"AGAIN: G1 X1", ParseStatus::kNamedWords, "G1 X1"},
    {"A1: X1", ParseStatus::kNamedWords, "X1"},
    {":10 G1 X1", ParseStatus::kNamedWords, "G1 X1"},
    {"R[5]=R[2]*3", ParseStatus::kNamedWords, ""},
    {"REPEAT AGAIN P=3", ParseStatus::kFlow, ""},
    {"L100 P3", ParseStatus::kForeign, ""},
    {"M17", ParseStatus::kForeign, ""},
    {"%_N_PART_MPF", ParseStatus::kProgramMark, ""},
    {";$PATH=/_N_WKS_DIR", ParseStatus::kNone, ""},
    {"G1 X1EX-3", ParseStatus::kUnreadable, "G1"},
    {"X1.2.3", ParseStatus::kUnreadable, ""},
    {"X1 2", ParseStatus::kUnreadable, "X1"},
    {"G1 (no comment)", ParseStatus::kUnreadable, "G1"},
    {"MSG(\"a", ParseStatus::kUnreadable, ""},
    {"/3 G1 X1", ParseStatus::kNone, "G1 X1"}};

TEST(SiemensLine, IsReadAsTheControlReadsIt) {
  for (const LineCase& test : kSiemensLineRows) {
    SCOPED_TRACE(test.line);
    Diagnostics found;
    const Program program = siemens(test.line, found);
    ASSERT_EQ(program.blocks.size(), 1U);
    EXPECT_EQ(program.blocks[0].opacity, test.opacity);
    EXPECT_EQ(words_of(program), test.words);
  }
}

TEST(SiemensParser, TheIsoModeIsNotReadUntilItEnds) {
  Diagnostics found;
  const Program program = siemens("G291\nG1 X290\nG290\nG1 X2\n", found);
  EXPECT_EQ(program.blocks[1].opacity, ParseStatus::kForeign);
  EXPECT_EQ(program.blocks[3].opacity, ParseStatus::kNone);
}

TEST(SiemensValue, EndsWhereTheNextWordStarts) {
  const std::string_view text = "R1*(2+SIN(R3)) DIV 3 Y5";
  EXPECT_EQ(after_siemens_expression(text, 0), text.find(" Y5"));
  EXPECT_EQ(after_siemens_expression("1+", 0), std::nullopt);
  EXPECT_EQ(after_siemens_number("1.5EX3", 0), std::nullopt);
}

// What is known of the state after a line, from a state in which all is known.
struct EffectCase {
  const char* line;
  const char*
      after;  // "place", "state" (all but the place is known), "nothing", or the reason's id
};

Interpretation read_program(const std::string& text) {
  Diagnostics found;
  return interpret(siemens(text, found), {}, found);
}

const EffectCase kSiemensEffectRows[] = {{"SOFT FFWON", "place"},
                                         {"CYCLE832(0.01,1,1)", "place"},
                                         {"COMPOF", "place"},
                                         {"COMPCAD", "bent"},
                                         {"COMPCAD COMPOF", "place"},
                                         {"G642", "place"},
                                         {"MSG(\"ROT X45\")", "place"},
                                         {"R1=5", "place"},
                                         {"G1 X5 SOFT", "place"},
                                         {"TRANS X10", "state"},
                                         {"ROT Z45", "bent"},
                                         {"ROT RPL=45", "bent"},
                                         {"AROT", "bent"},
                                         {"SCALE X2", "bent"},
                                         {"MIRROR X0", "bent"},
                                         {"ROT", "state"},
                                         {"CYCLE800(1,\"TC1\",0,57,0,0,0,0,0,0,0,0,0,-1)", "bent"},
                                         {"CYCLE800()", "state"},
                                         {"TRAORI", "bent"},
                                         {"TRANSMIT", "bent"},
                                         {"TRACYL(40)", "bent"},
                                         {"TRAFOOF", "state"},
                                         {"G505", "state"},
                                         {"G500", "state"},
                                         {"G75 X1=0", "state"},
                                         {"G74 Z0", "state"},
                                         {"G111 X5 Y5", "place"},
                                         {"D2", "state"},
                                         {"BSPLINE X5 Y5", "state"},
                                         {"CIP X5 Y5 I1=2 J1=3", "state"},
                                         {"G1 X5 RND=2", "state"},
                                         {"G1 AP=45 RP=10", "state"},
                                         {"MY_CYCLE(1,2)", "nothing"},
                                         {"$P_UIFR[1]=5", "nothing"},
                                         {"AGAIN:", "place"},
                                         {"A: G1 X5", "place"},
                                         {":10 G90", "place"},
                                         {"IF R1>5 GOTOF :7", "place"},
                                         {"CASE R1 OF 1 GOTOF :7 DEFAULT GOTOF :8", "place"},
                                         {"R[5]=3", "place"},
                                         {"DYNFINISH ACC[X]=50 LIMS=9000", "place"},
                                         {"DIAMON", "state"},
                                         {"DIAMOF", "place"},
                                         {"CYCLE83(5,0,2,-20,,-5,,2,0,0,1,0)", "state"},
                                         {"SPOS=90", "place"},
                                         {"G1 X5 A3=0 B3=0 C3=1", "state"},
                                         {"G331 Z-5 K1", "state"},
                                         {"TOROT", "bent"},
                                         {"TOROTOF", "state"},
                                         {"L10", "nothing"},
                                         {"G810", "nothing"}};

TEST(SiemensEffect, IsForgottenAsFarAsItReaches) {
  for (const EffectCase& test : kSiemensEffectRows) {
    SCOPED_TRACE(test.line);
    const std::string text =
        "G71 G90 G17 G40 G64 G94 F500\nG1 X0 Y0 Z0\n" + std::string(test.line) + "\nG1 X1 Y1\n";
    const Interpretation read = read_program(text);
    ASSERT_EQ(read.blocks.size(), 4U);
    EXPECT_FALSE(read.blocks[2].barrier.empty());
    const ModalState& state = read.states[read.blocks[3].state_after];
    const bool known = is_known(state);
    const std::int32_t motion = read.blocks[3].motion;
    const bool placed = motion >= 0 && read.motions[static_cast<std::size_t>(motion)].start_known;
    const bool plain =
        state.tool_center_point == TriState::kOff && state.tilted_plane == TriState::kOff &&
        state.scaling == TriState::kOff && state.rotation == TriState::kOff &&
        state.mirror == TriState::kOff && state.polar == TriState::kOff &&
        state.polar_interpolation == TriState::kOff && state.cylindrical == TriState::kOff &&
        state.control_smoothing == TriState::kOff;
    const std::string_view after = !known   ? "nothing"
                                   : !plain ? "bent"
                                   : placed ? "place"
                                            : "state";
    EXPECT_EQ(after, test.after);
  }
}

// A name that the program has declared is a value, whatever it looks like; others may be axes.
TEST(SiemensVariables, ThatAreDeclaredChangeNothing) {
  SiemensVariables variables;
  add_declared_names(" REAL _A, B = 5, C[3] = SET(1,2), D=MAX(1,2) ; E", variables);
  add_declared_names(" STRING[20] NAME=\"X, Y\"", variables);
  add_declared_names(" CHAN INT n", variables);
  EXPECT_EQ(variables, (SiemensVariables{"_A", "B", "C", "D", "NAME", "N"}));
  const std::string head = "G71 G90 G17 G40 G64 G94 F500\nG1 X0 Y0 Z0\n";
  const Interpretation read =
      read_program(head + "DEF REAL DEPTH, W[3]\nDEPTH=R1*2\nW[2]=5\nG1 X1 Y1\n");
  EXPECT_TRUE(read.motions.back().start_known);
  EXPECT_EQ(read.blocks[3].barrier, reason::kAssignment);
  EXPECT_FALSE(is_known(read_program(head + "DEPTH=R1*2\n").states.back()));
}

// What a safe beginning says brings back all that a call has made unknown.
TEST(SiemensInterpreter, EveryModeCanBeSaidAgain) {
  const Interpretation read = read_program(
      "L100\nG17 G40 G90 G94 G97\nG64\nG71\nTRANS\nTRAFOOF\nCYCLE800()\nCOMPOF\nDIAMOF\nMCALL\n");
  EXPECT_FALSE(is_known(read.states[read.blocks[0].state_after]));
  EXPECT_TRUE(is_known(read.states.back()));
}

TEST(SiemensInterpreter, FollowsArcsWithCr) {
  // From (0,0) to (10,0) clockwise, radius 5: half a circle over (5,5).
  const Interpretation read = read_program("G71 G90 G17 F100\nG1 X0 Y0 Z0\nG2 X10 Y0 CR=5.001\n");
  ASSERT_EQ(read.motions.size(), 2U);
  const geometry::Arc* arc = read.motions[1].piece.arc();
  ASSERT_NE(arc, nullptr);
  EXPECT_NEAR(std::abs(arc->sweep), 3.1416, 0.05);
}

TEST(SiemensFlow, OnlyLabelsThatAreNamedAreEntered) {
  const Interpretation read = read_program("N10 G1 X1\nN20 X2\nIF R1>5 GOTOB N10\n");
  EXPECT_TRUE(read.blocks[0].entered_from_elsewhere);
  EXPECT_FALSE(read.blocks[1].entered_from_elsewhere);
  const Interpretation named = read_program("N10 G1 X1\nGOTOF LAST\nN20 X2\nLAST: M30\n");
  EXPECT_FALSE(named.blocks[0].entered_from_elsewhere);
  const Interpretation computed = read_program("N10 G1 X1\nGOTOF TARGET\nN20 X2\n");
  EXPECT_TRUE(computed.blocks[0].entered_from_elsewhere);
  const Interpretation label = read_program("IF R1>5 GOTOF LAST\nA: G1 X1\nLAST: M30\n");
  EXPECT_FALSE(label.blocks[1].entered_from_elsewhere);
  EXPECT_TRUE(label.blocks[2].entered_from_elsewhere);
  const Interpretation main = read_program(":10 G1 X1\n:20 X2\nGOTOB :010\n");
  EXPECT_TRUE(main.blocks[0].entered_from_elsewhere);
  EXPECT_FALSE(main.blocks[1].entered_from_elsewhere);
  const Interpretation text = read_program("A: G1 X1\nGOTOF \"A\" << R1\n");
  EXPECT_TRUE(text.blocks[0].entered_from_elsewhere);
  const Interpretation repeated = read_program("A: G1 X1\nB: X2\nREPEAT A P=3\n");
  EXPECT_TRUE(repeated.blocks[0].entered_from_elsewhere);
  EXPECT_FALSE(repeated.blocks[1].entered_from_elsewhere);
}

TEST(SiemensFlow, APartThatIsCalledAgainNamesItsLabels) {
  const std::string part = "N10 FIRST: G1 X1\nN20 X2\nN30 LAST: X3\n";
  for (const char* call : {"CALL BLOCK N10 TO N30", "call block N010 to LAST",
                           "N40 CALL BLOCK FIRST TO LAST ; again"}) {
    SCOPED_TRACE(call);
    const Interpretation read = read_program(part + call + "\n");
    EXPECT_TRUE(read.blocks[0].entered_from_elsewhere);
    EXPECT_FALSE(read.blocks[1].entered_from_elsewhere);
    EXPECT_TRUE(read.blocks[2].entered_from_elsewhere);
  }
  const Interpretation computed = read_program(part + "CALL BLOCK \"N\"<<R1 TO N30\n");
  EXPECT_TRUE(computed.blocks[0].entered_from_elsewhere);
}

// RET("N10") in a program that stands in another file goes on at N10 of the one that called.
TEST(SiemensFlow, ProgramsThatAreNotReadMayComeBackToAnyLabel) {
  for (const char* call : {"L100 P3", "PART", "N5 PART(1,2)", "CALL \"PART\"", "EXTCALL(\"PART\")",
                           "PCALL /_N_WKS_DIR/PART(1)", "MCALL PART(2)"}) {
    EXPECT_TRUE(read_program(std::string("N10 G1 X1\n") + call + "\n").blocks[0].label_referenced)
        << call;
  }
  for (const char* none :
       {"CYCLE81(5,0,2,-5)", "MCALL CYCLE81(5,0,2,-5)", "MCALL", "CYCLE832(0.01)", "R1=5",
        "MYVAR=5", "MYVAR[2]=5", "$TC_DP1[1,1]=120", "G0 SUPA Z0 D0", "TRANS X5", "DEF REAL A",
        "M3 S500", "MSG(\"PART\")", "T=\"MILL\""}) {
    EXPECT_FALSE(read_program(std::string("N10 G1 X1\n") + none + "\n").blocks[0].label_referenced)
        << none;
  }
}

TEST(SiemensParser, AnyBytesAreReadAndEveryByteIsInOneBlock) {
  const std::string sample =
      "%_N_P_MPF\n;$PATH=/_N_MPF_DIR\nN10 G71 G90 DEF REAL A\nN20 CYCLE832(0.01,1,1) MSG(\"a\")\n"
      "N30 G1 X=10 Y=R1*2 F=1000\nL1: G2 X10 CR=5 I=AC(5)\nIF (R1>5) AND (R2==3) GOTOF L1\n"
      "POLY PO[X]=(1,2,3) PL=2\r\nTRANS X1\n/1 G0 Z5 D1 T=\"A\"\nG291\nG1 (c)\nG290\nM30\n";
  constexpr std::string_view kBytes = "GX1=.()[];\"/:%&$_N \n\r\tR9EA-+*<>,\0\xFF";
  for (unsigned seed = 0; seed < 2000; ++seed) {
    std::mt19937 random(seed);
    std::string text = sample;
    for (unsigned i = 0; i < 1 + seed % 9; ++i) {
      const std::size_t at = random() % text.size();
      const char c = kBytes[random() % kBytes.size()];
      switch (random() % 3) {
        case 0:
          text[at] = c;
          break;
        case 1:
          text.insert(at, 1, c);
          break;
        default:
          text.erase(at, 1 + random() % 5);
      }
      if (text.empty()) text = "X";
    }
    ASSERT_EQ(promises::broken_by(text, Language::kSiemens), "") << "seed " << seed;
    (void)read_program(text);
  }
}

}  // namespace
}  // namespace batten::gcode
