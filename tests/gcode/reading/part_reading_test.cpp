// A program that is read part by part is the program that is read as a whole.
#include "gcode/reading/part_reading.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"

namespace batten::gcode {
namespace {

// Everything of a block that does not count within its part.
std::string words_read(const Program& program, const Block& block) {
  std::string text =
      fmt::format("{} {}-{}-{} {} {} {}", block.line, block.span.begin, block.span.end, block.end,
                  static_cast<int>(block.opacity), block.block_delete, block.has_checksum);
  for (const Word& word : program.words_of(block)) {
    text += fmt::format(" {}{}@{}", word.letter, word.value, word.span.begin);
  }
  for (const Comment& comment : program.comments_of(block)) {
    text += fmt::format(" ({}-{})", comment.span.begin, comment.span.end);
  }
  return text;
}

std::string words_read(const Interpretation& read, const BlockMeaning& block) {
  const ModalState& state = read.states[block.state_after];
  std::string text =
      fmt::format("{} {} {} {} {} {}", static_cast<int>(block.kind), block.barrier.id(),
                  static_cast<int>(state.motion), static_cast<int>(state.units),
                  static_cast<int>(state.plane), state.feed.value_or(-1));
  if (block.motion < 0) return text;
  const Motion& motion = read.motions[static_cast<std::size_t>(block.motion)];
  const geometry::Point3 from = geometry::start_point(motion.piece);
  const geometry::Point3 to = geometry::end_point(motion.piece);
  return text + fmt::format(" {} {} {} {} to {} {} {} {}", motion.start_known, from.x(), from.y(),
                            from.z(), motion.end_known, to.x(), to.y(), to.z());
}

std::vector<std::string> words_read(const Diagnostics& found) {
  std::vector<std::string> texts;
  for (const Diagnostic& each : found) {
    texts.push_back(fmt::format("{} {} {} {}", static_cast<int>(each.severity), each.id,
                                each.where.begin, each.message));
  }
  return texts;
}

struct WordsRead {
  std::vector<std::string> blocks;
  std::vector<std::string> meanings;
  std::vector<std::string> told;
  bool marks_close_nothing = true;
  bool reaches_out = false;
};

void add(const Program& part, const Interpretation& read, WordsRead& reading) {
  for (const Block& block : part.blocks) reading.blocks.push_back(words_read(part, block));
  for (const BlockMeaning& block : read.blocks) reading.meanings.push_back(words_read(read, block));
}

WordsRead as_a_whole(const std::string& text) {
  WordsRead reading;
  Diagnostics found;
  const Program program = parse(SourceText("part.nc", text), found);
  add(program, interpret(program, {}, found), reading);
  reading.told = words_read(found);
  return reading;
}

WordsRead in_parts(const std::string& text, std::size_t blocks) {
  const SourceText source("part.nc", text);
  WordsRead reading;
  TextCarry carry;
  ControlCarry control(Units::kUnknown);
  Diagnostics of_text;
  Diagnostics of_meaning;
  while (carry.begin < text.size()) {
    const Program part = parse_part(source, {.blocks = blocks}, carry, of_text);
    add(part, interpret_part(part, {}, control, of_meaning), reading);
  }
  finish_text(carry, of_text);
  finish_interpretation(control, of_meaning);
  of_text.insert(of_text.end(), of_meaning.begin(), of_meaning.end());
  reading.told = words_read(of_text);
  reading.marks_close_nothing = carry.marks.closes_nothing();
  reading.reaches_out = control.reaches_out;
  return reading;
}

std::string many(std::string_view line, int times) {
  std::string text;
  for (int i = 0; i < times; ++i) text += line;
  return text;
}

struct PartsCase {
  std::string text;
};

const PartsCase kPartReadingRows[] = {
    {"%\nO1000\nG21 G90\nG0 X1 Y2\nG1 X2 F100\nX3\nM30\n%\n"},
    {"G21\r\nG0 X1\r\n\r\nG1 X2 F5\rX3\nX4"},
    {"\xEF\xBB\xBFG21\nG1 X1 F1\n\xEF\xBB\xBFX2\n"},
    {std::string("G21\nG0 X1\x1A\nM30\n\x1A\0\0\n\x1A", 20)},
    {"(HEAD)\nO1\nG21 X1\nO2\nG0 X3\n"},
    {"G21\nG777\nG0 X1\nG777\nG778\nG1 X2 F9\n"},
    {"G20 G18 G91\nG0 X1\nX1\nG2 X1 Z1 I1 K0 F9\nX1 Z1 I1 K0\n"},
    {"G21\n" + many("X1 X2\nG1 ?\n", 70) + "M30\n"},
    {"G21 G0 X0 Y0\n" + many("G2 X3 Y3 I9 J2 F9\nG0 X0 Y0\n", 70)},
    {"G21\n" + many("G0 X1 (open\n", 60)},
    {"G90\nM3\nG1 X1 F2\nX2\n"},
    {"G90\n(no)\nM30\n"}};

TEST(PartReading, IsThatOfTheWhole) {
  for (const PartsCase& test : kPartReadingRows) {
    SCOPED_TRACE(test.text);
    const WordsRead whole = as_a_whole(test.text);
    for (const std::size_t blocks : {1, 2, 3, 7}) {
      SCOPED_TRACE(blocks);
      const WordsRead parts = in_parts(test.text, blocks);
      EXPECT_EQ(parts.blocks, whole.blocks);
      EXPECT_EQ(parts.meanings, whole.meanings);
      EXPECT_EQ(parts.told, whole.told);
      EXPECT_TRUE(parts.marks_close_nothing);
      EXPECT_FALSE(parts.reaches_out);
    }
  }
}

// Parts are held while their end is not known: taken apart anywhere and put together again they are
// what they were.
TEST(PartReading, IsTheSameTakenApartAndPutTogether) {
  for (const PartsCase& test : kPartReadingRows) {
    SCOPED_TRACE(test.text);
    const std::string text = test.text;
    Diagnostics ignored;
    const WordsRead whole = as_a_whole(text);
    const SourceText source("part.nc", text);
    for (std::uint32_t first = 0; first <= whole.blocks.size(); ++first) {
      TextCarry carry;
      ControlCarry control(Units::kUnknown);
      ReadPart held{parse_part(source, {}, carry, ignored), {}};
      held.meaning = interpret_part(held.program, {}, control, ignored);
      ReadPart rest = take_rest(held, first);
      WordsRead apart;
      add(held.program, held.meaning, apart);
      add(rest.program, rest.meaning, apart);
      EXPECT_EQ(apart.blocks, whole.blocks);
      EXPECT_EQ(apart.meanings, whole.meanings);
      append(held, std::move(rest));
      WordsRead together;
      add(held.program, held.meaning, together);
      EXPECT_EQ(together.blocks, whole.blocks);
      EXPECT_EQ(together.meanings, whole.meanings);
    }
  }
}

TEST(PartReading, TellsOfMarksThatCloseSomething) {
  for (const std::size_t blocks : {1, 2, 100}) {
    EXPECT_FALSE(in_parts("G21\n%\nG1 X1 F1\n", blocks).marks_close_nothing);
    EXPECT_FALSE(in_parts("%\nG21\n%\nG1 X1 F1\n", blocks).marks_close_nothing);
    EXPECT_TRUE(in_parts("G21\nG1 X1 F1\n%\n\n%\n", blocks).marks_close_nothing);
  }
}

TEST(PartReading, TellsOfPartsThatReachOut) {
  for (const std::size_t blocks : {1, 2, 100}) {
    for (const char* line :
         {"GOTO 10", "IF [#1 EQ 2] GOTO #3", "M99", "M98 P5 H20", "o1 while [#1 lt 2]", "o1 endif",
          "G71 P10 Q20", "WHILE [#1 LT 3] DO 1", "M97 P10"}) {
      EXPECT_TRUE(in_parts(fmt::format("G21\nG0 X1\n{}\nN10 G1 X2 F5\n", line), blocks).reaches_out)
          << line;
    }
  }
}

TEST(EndOfLines, IsBehindTheLineFeedThatFollows) {
  const SourceText source("part.nc", "G21\nG0 X1\nG1 X2 F5");  // line feeds at 3 and 9
  EXPECT_EQ(end_of_lines(source, 0, 1, 10), 4);
  EXPECT_EQ(end_of_lines(source, 0, 3, 10), 4);
  EXPECT_EQ(end_of_lines(source, 0, 4, 10), 10);
  EXPECT_EQ(end_of_lines(source, 4, 2, 10), 10);
}

TEST(EndOfLines, IsThatOfTheTextWhereLittleIsLeft) {
  const SourceText source("part.nc", "G21\nG0 X1\nG1 X2 F5");
  EXPECT_EQ(end_of_lines(source, 4, 14, 10), 18);
  EXPECT_EQ(end_of_lines(source, 18, 1, 10), 18);
}

TEST(EndOfLines, IsNowhereInALineThatIsTooLong) {
  const SourceText source("part.nc", "G21\nG0 X1\nG1 X2 F5");
  EXPECT_EQ(end_of_lines(source, 0, 4, 5), std::nullopt);
  EXPECT_EQ(end_of_lines(source, 0, 11, 3), std::nullopt) << "no line feed in the last line";
}

}  // namespace
}  // namespace batten::gcode
