// Heidenhain Klartext as blocks and words: a row for each construct, and what no text can break.
#include "gcode/klartext/parser.h"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "gcode/klartext/statement.h"
#include "gcode/text/number_format.h"
#include "tests/fuzz/parse_promises.h"

namespace batten::gcode {
namespace {

Program parsed(const std::string& text) {
  Diagnostics found;
  return parse_klartext(SourceText("part.h", text), found);
}

// "N12 G1 X1.5 Q?": letter and value; ? where the word has no number.
std::string words_of(const Program& program, const Block& block) {
  std::string said;
  for (const Word& word : program.words_of(block)) {
    if (!said.empty()) said += ' ';
    said += word.letter;
    said += word.is_number ? to_text(word.value, {.decimals = 6}) : "?";
  }
  return said;
}

struct LineCase {
  std::string text;
  std::string words;
  ParseStatus opacity = ParseStatus::kNone;
};

TEST(KlartextParser, CutsTheMoveInFrontOfALineThatItDoesNotRead) {
  EXPECT_EQ(parsed("L X+1\nCC\rRND R2\n").blocks[0].opacity, ParseStatus::kCornerWord);
}

const LineCase kKlartextLinesRows[] = {

    // Lines that controls read in two ways
    // The RND that may stand in such a line cuts the move before it.
    {"L X+1\rL Y+2", "", ParseStatus::kUnreadable},
    {"L X+1\r\nL Y+2\r\n", "G1 Y2"},
    {"L X+1\r\r\nL Y+2", "G1 Y2"},
    {std::string("\0L X+1", 6), "", ParseStatus::kUnreadable},
    {std::string("L X+1\0", 6), "", ParseStatus::kUnreadable},
    {std::string("\0\0", 2), "", ParseStatus::kProgramMark},
    // Moves
    {"12 L X+1.5 Y-2 R0 F500 M3", "N12 G1 X1.5 Y-2 G40 F500 M3"},
    {"L Z-5", "G1 Z-5"},
    {"12 L X+1,25", "N12 G1 X1.25"},
    {"12 l x+1 fmax", "N12 G0 X1"},
    {"12 L X1. Y.5", "N12 G1 X1 Y0.5"},
    {"12 L X +1 Y -2", "N12 G1 X1 Y-2"},
    {"12 L X+1 R0 FMAX M3", "N12 G0 X1 G40 M3"},
    {"12 L X+1 F MAX", "N12 G0 X1"},
    {"12 L X+1 RL F100", "N12 G1 X1 G41 F100"},
    {"12 L X+1 RR", "N12 G1 X1 G42"},
    {"12 L X+1 R F M", "N12 G1 X1"},
    {"4 L X34.129 Y36.811 R0 F8000 M", "N4 G1 X34.129 Y36.811 G40 F8000"},
    {"12 L X+1 A+30 C-90", "N12 G1 X1 A30 C-90"},
    {"12 M5 M9", "N12 M5 M9"},
    {"12 CC X+10 Y+0", "N12"},
    {"5 CC X+10 Y-1.5\n12 C X+20 Y+0 DR-", "N12 G2 X20 Y0 I10 J-1.5"},
    {"CC Y+1 X+10\nC X+20 DR+ R0 F10 M", "G3 X20 G40 F10 J1 I10"},
    {"12 C X+1 Y+1 DR+", "N12 G3 X1 Y1"},
    {"12 CR X+5 Y+0 R+20.5 DR+ R0 F9", "N12 G3 X5 Y0 R20.5 G40 F9"},
    {"12 CR X+5 Y+0 R-20 DR-", "N12 G2 X5 Y0 R-20"},
    // Parameters
    {"12 L X+Q5 Y1", "N12 G1 X? Y1", ParseStatus::kExpression},
    {"12 L XQ5", "N12 G1 X?", ParseStatus::kExpression},
    {"12 L X-QL12", "N12 G1 X?", ParseStatus::kExpression},
    {"12 L X+1 FQ20", "N12 G1 X1 F?", ParseStatus::kExpression},
    {"12 L X+1 F Q20", "N12 G1 X1 F?", ParseStatus::kExpression},
    {"12 L X+1 F AUTO", "N12 G1 X1 F?", ParseStatus::kExpression},
    {"12 L X+1 FAUTO", "N12 G1 X1 F?", ParseStatus::kExpression},
    // Copied
    {"0 BEGIN PGM PART MM", "N0", ParseStatus::kProgramMark},
    {"9 END PGM PART MM", "N9", ParseStatus::kProgramMark},
    {"12 L IX+1", "N12", ParseStatus::kForeign},
    {"12 L X+1 FZ0.1", "N12", ParseStatus::kForeign},
    {"12 L X+1 M91", "N12", ParseStatus::kForeign},
    {"12 M128 F500", "N12", ParseStatus::kForeign},
    {"12 L X+1 RL M120 LA5", "N12", ParseStatus::kForeign},
    {"CC X+0 Y+0\n12 C X+1 Y+1", "N12 I0 J0", ParseStatus::kForeign},
    {"CC X+0 Y+0\n12 C X+1 Z+1 DR+", "N12 I0 J0", ParseStatus::kForeign},
    {"12 CR X+5 DR+", "N12", ParseStatus::kForeign},
    {"12 CC IX+10 Y+0", "N12", ParseStatus::kForeign},
    {"12 CC", "N12", ParseStatus::kForeign},
    {"5 CC X+1 Y+2\n12 LP PR+10 PA+30", "N12 I1 J2", ParseStatus::kForeign},
    {"CC X+1 Y+2\n12 CP IPA+360 IZ-1 DR+", "N12 I1 J2", ParseStatus::kForeign},
    {"12 CT X+1 Y+1", "N12", ParseStatus::kForeign},
    {"12 RND R2", "N12", ParseStatus::kForeign},
    {"12 CHF 2", "N12", ParseStatus::kForeign},
    {"12 APPR LCT X+1 Y+1 R5 RL F10", "N12", ParseStatus::kForeign},
    {"12 DEP LT LEN5", "N12", ParseStatus::kForeign},
    {"12 LN X+1 Y+1 Z+1 NX0 NY0 NZ1", "N12", ParseStatus::kForeign},
    {"12 TOOL CALL 5 Z S5000", "N12", ParseStatus::kForeign},
    {"12 TOOL DEF 5 L+0 R+3", "N12", ParseStatus::kForeign},
    {"12 BLK FORM 0.1 Z X+0 Y+0 Z-20", "N12", ParseStatus::kForeign},
    {"12 CYCL DEF 200 DRILLING ~", "N12", ParseStatus::kForeign},
    {"12 CYCL DEF 200 DRILLING ~\n  Q200=+2 ;CLEARANCE", "", ParseStatus::kContinued},
    {"12 CYCL DEF 200 ~\n Q200=2 ;A ~\n Q201=3 ;B", "", ParseStatus::kContinued},
    {"12 L X+1 ~\n  Y+2", "", ParseStatus::kContinued},
    {"8 SPL X+18 Y+6.4\n  K3X-6 K2X+0 K1X-1.2E+001", "", ParseStatus::kContinued},
    {"12 CYCL CALL M3", "N12", ParseStatus::kForeign},
    {"12 PLANE RESET STAY", "N12", ParseStatus::kForeign},
    {"12 STOP M6", "N12", ParseStatus::kForeign},
    {"12 TCH PROBE 0.0 REF. PLANE Q5 X-", "N12", ParseStatus::kForeign},
    {"12 Q5 = Q1 + 3", "N12", ParseStatus::kAssignment},
    {"12 FN 0: Q5 = +3", "N12", ParseStatus::kAssignment},
    {"12 FN 9: IF +Q1 EQU +Q2 GOTO LBL 5", "N12", ParseStatus::kFlow},
    {"12 LBL 1", "N12", ParseStatus::kFlow},
    {"12 LBL \"a;b\"", "N12", ParseStatus::kFlow},
    {"12 CALL LBL 1 REP 5", "N12", ParseStatus::kFlow},
    {"12 CALL PGM TNC:\\X.H", "N12", ParseStatus::kFlow},
    {"12 XYZZY", "N12", ParseStatus::kForeign},
    {std::string("L X+1\n") + '\x1A', "", ParseStatus::kProgramMark}};

TEST(KlartextLines, AreReadAsWords) {
  for (const LineCase& test : kKlartextLinesRows) {
    SCOPED_TRACE(test.text);
    const Program program = parsed(test.text);
    ASSERT_FALSE(program.blocks.empty());
    const Block& last = program.blocks.back();
    EXPECT_EQ(words_of(program, last), test.words);
    EXPECT_EQ(last.opacity, test.opacity);
  }
}

TEST(KlartextParser, KeepsComments) {
  const Program program = parsed("1 L X+1 ; go\n2 * - SLOT 5\n3 ; only\n");
  ASSERT_EQ(program.comments.size(), 3U);
  EXPECT_EQ(program.source.text(program.comments[0].span), "; go");
  EXPECT_EQ(program.source.text(program.comments[1].span), "* - SLOT 5");
  EXPECT_EQ(program.source.text(program.comments[2].span), "; only");
  for (const Block& block : program.blocks) EXPECT_EQ(block.opacity, ParseStatus::kNone);
}

TEST(KlartextParser, KnowsHiddenBlocks) {
  EXPECT_TRUE(parsed("/12 L X+1").blocks[0].block_delete);
  EXPECT_TRUE(parsed("12 / L X+1").blocks[0].block_delete);
  EXPECT_FALSE(parsed("12 L X+1").blocks[0].block_delete);
}

// The line before does not reach its end, or gives the next one its direction.
TEST(KlartextParser, MarksMovesThatLaterBlocksDependOn) {
  for (const std::string next : {"RND R2", "CHF 1", "CT X+5 Y+5", "DEP LT LEN5", "FCT DR- R5"}) {
    const Program program =
        parsed("1 L X+0 Y+0\n2 L X+9 ; a\n3 ; b\n4 " + next + "\n5 L X+9 Y+9\n");
    EXPECT_EQ(program.blocks[0].opacity, ParseStatus::kNone) << next;
    EXPECT_EQ(program.blocks[1].opacity, ParseStatus::kCornerWord) << next;
    EXPECT_EQ(program.blocks[4].opacity, ParseStatus::kNone) << next;
  }
}

// After a datum shift the numbers of an earlier centre are no place any more.
TEST(KlartextParser, ForgetsCentresWhereCoordinatesChange) {
  const Program program = parsed("CC X+1 Y+2\nCYCL DEF 7.1 X+5\nC X+5 Y+5 DR+\n");
  EXPECT_EQ(words_of(program, program.blocks.back()), "G3 X5 Y5 I? J?");
}

// --- any text -----------------------------------------------------------------------------------

const std::string& every_construct() {
  static const std::string kText =
      "\xEF\xBB\xBF"
      "0 BEGIN PGM PART MM\r\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 TOOL CALL \"D6;x\" Z S8000 F500\n"
      "3 CYCL DEF 200 DRILLING ~\n  Q200=+2 ;CLEARANCE ~\n  Q201=-5\n4 L X+1,5 Y-2 R0 FMAX M3\n"
      "5 CC X+0 Y+0\n6 C X+1,5 Y+2 DR+ F300\n7 CR X+5 Y+0 R+20 DR-\n8 LP PR+5 PA+30\n"
      "9 RND R2\n10 APPR LT X+0 Y+0 LEN5 RL\n11 DEP LT LEN5\n12 LBL 1\n13 CALL LBL 1 REP 2\n"
      "14 FN 9: IF +Q1 EQU +Q2 GOTO LBL \"N\"\n15 Q1 = Q2 * 3\n16 M140 MB MAX\n"
      "17 SPL X+18 Y+6.4 ~\n  K3X-6 K2X+0 K1X-1.2E+001 ~\n  K3Y+5.6 K2Y-4.8 K1Y-7.2 F3000\n"
      "18 PLANE RESET STAY\n/19 L X+Q5 IY-2 F AUTO\n20 * - TEXT\n21 STOP M6\n22 END PGM PART "
      "MM\n\x1A";
  return kText;
}

TEST(KlartextParser, PutsEveryByteIntoOneBlock) {
  EXPECT_EQ(promises::broken_by(every_construct(), Language::kKlartext), "");
}

TEST(KlartextParser, PutsEveryByteOfDamagedTextIntoOneBlock) {
  std::mt19937 random(7);
  const std::string sound = every_construct();
  const std::string signs = "+-.,;~*/\"0123456789XYZLCRFMQKE \n\r\t" + std::string(1, '\0');
  const auto below = [&](std::size_t limit) { return random() % limit; };
  for (int round = 0; round < 3000; ++round) {
    std::string text = sound;
    for (int change = 0; change < 4; ++change) {
      const std::size_t at = below(text.size());
      switch (below(3)) {
        case 0:
          text[at] = signs[below(signs.size())];
          break;
        case 1:
          text.erase(at, below(20));
          break;
        default:
          text.insert(at, text.substr(below(text.size()), below(30)));
      }
      if (text.empty()) break;
    }
    ASSERT_EQ(promises::broken_by(text, Language::kKlartext), "") << text;
  }
}

}  // namespace
}  // namespace batten::gcode
