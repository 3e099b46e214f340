#include "gcode/reading/parser.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/fuzz/parse_promises.h"
#include "tests/support/places.h"

namespace batten::gcode {
namespace {

struct Parsed {
  Program program;
  Diagnostics found;
};

Parsed parsed(const std::string& text) {
  Diagnostics found;
  Program program = parse(SourceText("part.nc", text), found);
  return {std::move(program), std::move(found)};
}

const char* name_of(ParseStatus opacity) {
  constexpr std::array<const char*, 8> kNames = {"words", "unreadable", "expression", "assignment",
                                                 "flow",  "foreign",    "mark",       "corner"};
  return kNames[static_cast<std::size_t>(opacity)];
}

// The words of a block as letters and values: "G1 X2.5 Y?"; ? where there is no number.
std::string words_of(const Program& program, const Block& block) {
  std::ostringstream text;
  for (const Word& word : program.words_of(block)) {
    text << (text.tellp() > 0 ? " " : "") << word.letter;
    word.is_number ? text << word.value : text << '?';
  }
  return text.str();
}

// One line per block: "words: G1 X2".
std::vector<std::string> blocks_of(const std::string& text) {
  const Parsed read = parsed(text);
  std::vector<std::string> blocks;
  for (const Block& block : read.program.blocks) {
    const std::string words = words_of(read.program, block);
    blocks.push_back(std::string(name_of(block.opacity)) + (words.empty() ? "" : ": " + words));
  }
  return blocks;
}

using Blocks = std::vector<std::string>;

struct BlockCase {
  std::string line;
  std::string block;
};

const BlockCase kReadsBlockRows[] = {{"g1 X-.5 Y5.", "words: G1 X-0.5 Y5"},
                                     {"G0X +0. 12 34Y 7", "words: G0 X0.1234 Y7"},
                                     {"X-0.", "words: X0"},
                                     {"", "words"},
                                     {" \t ", "words"},
                                     {"(G1 X5)", "words"},
                                     {"G1 X1 (c) Y2 ; d", "words: G1 X1 Y2"},
                                     {"G1 X[#1+2] Y3", "expression: G1 X? Y3"},
                                     {"N10 #1=5 (c)", "assignment: N10"},
                                     {"#1=5 X3", "unreadable: X3"},
                                     {"X#1 #1=5", "unreadable: X?"},
                                     {"G1 X1,R2", "corner: G1 X1 ,2"},
                                     {"G1 X#1,C2", "corner: G1 X? ,2"},
                                     {"G1 ,C2 X#1", "corner: G1 ,2 X?"},
                                     {"N10 IF [#1 EQ 2] GOTO 50", "flow: N10"},
                                     {"o<sub> call", "flow"},
                                     {"O2000 (second)", "flow: O2000"},
                                     {"N5 G1 X1=10", "foreign: N5 G1"},
                                     {"G1 X1E3", "unreadable: G1"},
                                     {"/2 G1 X1", "words: G1 X1"},
                                     {"N5 /G1", "words: N5 G1"},
                                     {"G1 /X1", "unreadable: G1 X1"},
                                     {"//G1", "unreadable: G1"},
                                     {"G1 X1*88", "unreadable: G1 X1"},
                                     {"N5 G1 X1*88", "unreadable: N5 G1 X1"},
                                     {std::string("G1\0X\x1A", 5), "unreadable: G1"},
                                     {std::string("\0 G1", 4), "unreadable: G1"},
                                     {std::string("G1\0\0", 4), "unreadable: G1"},
                                     {std::string("(a\0b) G1", 9), "unreadable: G1"},
                                     {std::string("\0\0", 2), "mark"}};

TEST(ReadsBlock, AsItIs) {
  for (const BlockCase& test : kReadsBlockRows) {
    SCOPED_TRACE(test.line);
    // A plain block before, so that the line is not the first of a program.
    EXPECT_EQ(blocks_of("G21\n" + test.line + "\n").at(1), test.block);
  }
}

// Its words would take thirty bytes of memory for every two of it.
TEST(Parser, ReadsNoLineThatNoControlCouldTake) {
  std::string line = "G1";
  while (line.size() <= (1U << 20)) line += "X1";
  EXPECT_EQ(blocks_of("M3\n" + line + "\nM30\n"),
            (Blocks{"words: M3", "unreadable", "words: M30"}));
  line.resize(1U << 20);
  EXPECT_TRUE(blocks_of(line).front().starts_with("words: G1 X1"));
}

TEST(Parser, RemembersBlockDelete) {
  const Program program = parsed("/G1\n/2G1\nN1/3G1\nG1\n").program;
  EXPECT_TRUE(program.blocks[0].block_delete);
  EXPECT_TRUE(program.blocks[1].block_delete);
  EXPECT_TRUE(program.blocks[2].block_delete);
  EXPECT_FALSE(program.blocks[3].block_delete);
}

TEST(Parser, TakesAChecksumThatFitsItsLine) {
  // The exclusive or of the bytes of `N3 T0`, the example of the RepRap pages: 57.
  const Program program = parsed("N3 T0*57\nN3 T0*56\nN3 T0\n").program;
  EXPECT_EQ(program.blocks[0].opacity, ParseStatus::kNone);
  EXPECT_TRUE(program.blocks[0].has_checksum);
  EXPECT_EQ(program.blocks[1].opacity, ParseStatus::kUnreadable);
  EXPECT_FALSE(program.blocks[2].has_checksum);
}

TEST(Parser, SaysHowWordsWereWritten) {
  const Program program = parsed("X5 X5. X5.00 X[1]\n").program;
  const auto words = program.words_of(program.blocks[0]);
  ASSERT_EQ(words.size(), 4u);
  EXPECT_FALSE(words[0].has_point);
  EXPECT_TRUE(words[1].has_point);
  EXPECT_EQ(words[1].decimals, 0);
  EXPECT_EQ(words[2].decimals, 2);
  EXPECT_FALSE(words[3].is_number);
  EXPECT_EQ(program.source.text(words[2].span), "X5.00");
}

TEST(Parser, KeepsCommentsWithTheirKind) {
  const Program program = parsed("(a) X1 ( m s g, b) ; c\n").program;
  const auto comments = program.comments_of(program.blocks[0]);
  ASSERT_EQ(comments.size(), 3u);
  EXPECT_EQ(comments[0].kind, CommentKind::kParenthesis);
  EXPECT_EQ(comments[1].kind, CommentKind::kActive);
  EXPECT_EQ(comments[2].kind, CommentKind::kSemicolon);
  EXPECT_EQ(program.source.text(comments[1].span), "( m s g, b)");
  EXPECT_EQ(program.source.text(comments[2].span), "; c");
}

TEST(Parser, ReadsAnyLineEndAndAMissingLastOne) {
  const Blocks expected = {"words: G1", "words", "words: X1", "words: Y2"};
  EXPECT_EQ(blocks_of("G1\n\nX1\nY2"), expected);
  EXPECT_EQ(blocks_of("G1\r\n\r\nX1\r\nY2"), expected);
  EXPECT_EQ(blocks_of("G1\r\n\nX1\r\nY2\n"), expected);
  EXPECT_EQ(blocks_of(""), Blocks{});
}

// A CR that no LF follows ends a line for some controls and is left out by others. That is the same
// where only one of the lines between two LFs says anything.
TEST(Parser, ReadsNoLinesThatAnotherControlWouldJoin) {
  const Blocks gap = {"words: G1", "words", "words: X1", "words"};
  EXPECT_EQ(blocks_of("G1\r\r\nX1\r\r\n"), gap);
  EXPECT_EQ(blocks_of("G1\n\rX1\n\r"), gap);
  EXPECT_EQ(blocks_of("G1\r \t\nX1\n \r"), gap);
  EXPECT_EQ(blocks_of("G1\r"), Blocks{"words: G1"});

  EXPECT_EQ(blocks_of("M3\nG1\rX1\nY2\n"),
            (Blocks{"words: M3", "unreadable", "unreadable", "words: Y2"}));
  EXPECT_EQ(blocks_of("G1\rX1\rY2\r"), (Blocks{"unreadable", "unreadable", "unreadable"}));
  EXPECT_EQ(blocks_of("M3\n\r\rG1\r\rX1\r\r\nY2\n"),
            (Blocks{"words: M3", "words", "words", "unreadable", "words", "unreadable", "words",
                    "words: Y2"}));
  EXPECT_EQ(blocks_of("%\rG1\r%\nX1\n"),
            (Blocks{"unreadable", "unreadable", "unreadable", "words: X1"}));
  EXPECT_EQ(blocks_of("(a)\rG1\n"), (Blocks{"unreadable", "unreadable"}));
}

TEST(Parser, SkipsAByteOrderMark) {
  EXPECT_EQ(blocks_of("\xEF\xBB\xBFG21\nX1\n"), (Blocks{"words: G21", "words: X1"}));
  EXPECT_EQ(blocks_of("\xEF\xBB\xBF%\nX1\n%\n"), (Blocks{"mark", "words: X1", "mark"}));
}

TEST(Parser, SkipsTapeLeadersAndTheEndOfFileSign) {
  EXPECT_EQ(blocks_of(std::string("\0\0\0%\nX1\nM30\n\x1A\0", 14)),
            (Blocks{"mark", "words: X1", "words: M30", "mark"}));
  EXPECT_EQ(blocks_of("M30\x1A"), (Blocks{"words: M30"}));
  EXPECT_EQ(blocks_of("\x1A\nM30\n"), (Blocks{"unreadable", "words: M30"}));
}

TEST(Parser, TheFirstNumberIsTheProgramsOwn) {
  EXPECT_EQ(blocks_of("%\n(c)\nO1000 (part)\nX1\nO2000\n%\n"),
            (Blocks{"mark", "words", "mark: O1000", "words: X1", "flow: O2000", "mark"}));
  EXPECT_EQ(blocks_of("G21\nO1000\n"), (Blocks{"words: G21", "flow: O1000"}));
  EXPECT_EQ(blocks_of("#1=2\nO1000\n").back(), "flow: O1000");
  EXPECT_EQ(blocks_of("/O1000\n").back(), "flow: O1000");
  EXPECT_EQ(blocks_of(":1000\n:2000\n"), (Blocks{"mark: O1000", "flow: O2000"}));
}

TEST(ProgramMarks, BoundTheProgram) {
  EXPECT_EQ(blocks_of("%\nX1\n%\nX2\n\n"), (Blocks{"mark", "words: X1", "mark", "mark", "mark"}));
  EXPECT_EQ(blocks_of("%prog1\nX1\n"), (Blocks{"mark", "words: X1"}));
}

TEST(ProgramMarks, ASingleOneAtTheEndEndsTheProgram) {
  EXPECT_EQ(blocks_of("X1\nM30\n%\n\n"), (Blocks{"words: X1", "words: M30", "mark", "words"}));
}

// What is sent to an Okuma control has the name of the file in front; $ lines of grbl are others.
TEST(ProgramMarks, AreFileNamesOfOkuma) {
  EXPECT_EQ(blocks_of("$PART-1.MIN%\nO1\nX1\n"), (Blocks{"mark", "mark: O1", "words: X1"}));
  EXPECT_EQ(blocks_of("X1\n$A.MIN%\n").back(), blocks_of("X1\n$H\n").back());
  for (const char* line : {"$H", "$J=G91 X1", "$10=%", "$100%", "$A.B.C%"}) {
    EXPECT_NE(blocks_of(std::string(line) + "\n").front(), "mark") << line;
  }
}

TEST(ProgramMarks, WordsBeforeTheFirstAreDoubtful) {
  const Parsed read = parsed("(c)\nG20\n%\nX1\n");
  EXPECT_EQ(blocks_of("(c)\nG20\n%\nX1\n"),
            (Blocks{"words", "unreadable: G20", "mark", "words: X1"}));
  ASSERT_EQ(read.found.size(), 1u);
  EXPECT_EQ(read.found[0].id, "text-outside-marks");
  EXPECT_EQ(read.found[0].severity, Severity::kWarning);
}

std::string only_diagnostic(const std::string& text) {
  const Parsed read = parsed(text);
  EXPECT_EQ(read.found.size(), 1u) << text;
  return read.found.empty() ? "" : to_text(read.found[0], read.program.source);
}

TEST(ParserDiagnostics, NameTheForeignLanguageOnce) {
  const std::string expected =
      "; expected a program of the RS-274 family (G01 X.. Y..): this language is not read";
  EXPECT_EQ(only_diagnostic("0 BEGIN PGM TEST MM\n1 L X+1\n2 END PGM TEST MM\n"),
            "part.nc:1:1: error: foreign-language: found BEGIN PGM, so this is a program in "
            "Heidenhain Klartext" +
                expected);
  EXPECT_EQ(only_diagnostic("%_N_TEST_MPF\n;$PATH=/_N_MPF_DIR\nDEF REAL A=5\nG1 X1\n"),
            "part.nc:1:1: error: foreign-language: found %_N_, so this is a program in Siemens "
            "Sinumerik" +
                expected);
  EXPECT_EQ(only_diagnostic("G1 X1\n N10 def real A=5\n"),
            "part.nc:2:2: error: foreign-language: found DEF with a type, so this is a program in "
            "Siemens Sinumerik" +
                expected);
  EXPECT_TRUE(parsed("G1 X1\nCALL X\nDEF FOO\n(BEGIN PGM)\n; $PATH\n").found.empty());
}

TEST(ParserDiagnostics, SayWhatCannotBeReadAndWhere) {
  EXPECT_EQ(only_diagnostic("G21\nG1 X1E3\n"),
            "part.nc:2:6: warning: unreadable-block: an E right after a number, which may be an "
            "exponent or a word; the block is copied as it is");
  EXPECT_EQ(only_diagnostic("(a\nG1 X1\n"),
            "part.nc:1:1: warning: unclosed-comment: '(' without ')'; read as a comment up to the "
            "end of the line");
  EXPECT_EQ(only_diagnostic("%\nG1\n%\nX1\n"),
            "part.nc:3:1: note: text-outside-marks: words stand after this second % line, which "
            "ends the program; they are copied as they are");
}

TEST(ParserDiagnostics, RefuseTextOfSixteenBits) {
  const Parsed read =
      parsed(std::string("\xFF\xFEG\0"
                         "1\0\n\0",
                         8));
  ASSERT_FALSE(read.found.empty());
  EXPECT_EQ(read.found[0].id, "sixteen-bit-text");
  EXPECT_TRUE(has_error(read.found));
}

TEST(ParserDiagnostics, DoNotBuryTheReader) {
  std::string text;
  for (int i = 0; i < 1000; ++i) {
    text += "G1 X\n";
  }
  const Parsed read = parsed(text);
  ASSERT_EQ(read.found.size(), 51u);
  EXPECT_EQ(read.found.back().message, "from here on 950 more blocks of this kind");
  EXPECT_EQ(promises::broken_by(text), "");
}

// A block that is no more told for its first fault is told for its second.
TEST(ParserDiagnostics, TellTheNumberOfTheRestBesideWhatIsToldOfTheSameBlock) {
  std::string text;
  for (int i = 0; i < 52; ++i) text += "G1 X (open\n";
  EXPECT_EQ(promises::broken_by(text), "");
}

TEST(ParserDiagnostics, StaySilentAboutGoodPrograms) {
  EXPECT_TRUE(
      parsed("%\nO1 (part)\nG21 G90\nG1 X1 F100\nX[#1]\n#1=2\nIF[1]GOTO5\n%\n").found.empty());
}

// Pieces that programs are made of, good and bad.
const std::vector<std::string>& pieces() {
  static const std::vector<std::string> kPieces = [] {
    std::vector<std::string> all = {std::string(1, '\0')};
    std::istringstream table(
        "G1|X1.5|Y-.25|Z 0. 1|F100|N10|M3|e5|(c)|(msg,a)|; d|/|/2|%|%p|O100|o<a>|#1=|#<b>|"
        "[#1+2]|X[1]|SIN[3|IF[1]|GOTO5|*71|,R2|,C|\"s|'|$1=2|{|!a|@1|^2|<|12 |L X+1 |=10|R1=|"
        "DEF REAL |CALL |:|_|+|-|.|1e3|\n|\r\n|\r| |\t|(|)|\x1A|\xEF\xBB\xBF|\xC3\xA9|\xFF|"
        "9999999999999999999999|BEGIN PGM |%_N_A_MPF|;$PATH");
    for (std::string piece; std::getline(table, piece, '|');) all.push_back(piece);
    return all;
  }();
  return kPieces;
}

TEST(Parser, KeepsItsPromisesForAnyBytes) {
  constexpr int kTexts = 20'000;
  for (int seed = 0; seed < kTexts; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::string text;
    for (unsigned i = random() % 60; i > 0; --i) {
      text.push_back(static_cast<char>(random() % 256));
    }
    ASSERT_EQ(promises::broken_by(text), "") << "seed " << seed;
  }
}

TEST(Parser, KeepsItsPromisesForMixedPieces) {
  constexpr int kTexts = 40'000;
  for (int seed = 0; seed < kTexts; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::string text;
    for (unsigned i = random() % 30; i > 0; --i) {
      text += pieces()[random() % pieces().size()];
    }
    ASSERT_EQ(promises::broken_by(text), "") << "seed " << seed << ": " << text;
  }
}

TEST(Parser, KeepsItsPromisesForEveryPairOfPieces) {
  for (const std::string& first : pieces()) {
    for (const std::string& second : pieces()) {
      ASSERT_EQ(promises::broken_by(first + second), "") << first << second;
      ASSERT_EQ(promises::broken_by("G1" + first + "X1" + second + "\n%\n"), "") << first << second;
    }
  }
}

TEST(Parser, WordsAreWhatAPlainReaderFinds) {
  // Lines that are printed from numbers must give these numbers, whatever the blanks.
  constexpr int kLines = 20'000;
  std::mt19937 random(7);
  for (int i = 0; i < kLines; ++i) {
    const int x = static_cast<int>(random() % 2'000'001) - 1'000'000;
    const int y = static_cast<int>(random() % 2'000'001) - 1'000'000;
    std::array<char, 80> line{};
    const char* const formats[] = {"G1X%.3fY%.3f", "g1 x %+.3f  y%.3f", "N5 G01 X%.3f(c)Y%.3f;d",
                                   "/G1\tX%.3f\tY%.3f"};
    std::snprintf(line.data(), line.size(), formats[random() % 4], x / 1000.0, y / 1000.0);
    const Program program = parsed(line.data()).program;
    const auto words = program.words_of(program.blocks.at(0));
    ASSERT_EQ(program.blocks[0].opacity, ParseStatus::kNone) << line.data();
    ASSERT_EQ(words[words.size() - 2].value, x / 1000.0) << line.data();
    ASSERT_EQ(words[words.size() - 1].value, y / 1000.0) << line.data();
  }
}

TEST(Parser, ReadsLinesOfAnyLength) {
  constexpr int kWords = 200'000;
  std::string line;
  for (int i = 0; i < kWords; ++i) {
    line += "X1.5 ";
  }
  EXPECT_EQ(parsed(line).program.words.size(), static_cast<std::size_t>(kWords));
  // These would take hours if any part of the line were looked at again and again.
  for (const std::string piece : {"(() ", "X[", "X#<", "#1=", "#", "(", ")", "X#", "1+", "/", "\r",
                                  "SIN", "X SIN[", "\"", " ", "\r\n", ",R", "[["}) {
    std::string text;
    while (text.size() < 1'000'000) {
      text += piece;
    }
    EXPECT_EQ(promises::broken_by(text), "") << piece;
    EXPECT_EQ(promises::broken_by("#1=" + text), "") << piece;
  }
}

std::filesystem::path corpus_folder() {
  const char* given = std::getenv("BATTEN_CORPUS");
  return given != nullptr ? std::filesystem::path(given)
                          : std::filesystem::path(BATTEN_SOURCE_DIR) / ".." / "shared" / "corpus";
}

std::string bytes_of(const std::filesystem::path& file) {
  if (file.extension() == ".gz") {
    const std::string command = "gzip -dc '" + file.string() + "'";
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
    std::string text;
    std::array<char, 1 << 16> part{};
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe.get())) {
      text.append(part.data(), count);
    }
    return text;
  }
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Parser, KeepsItsPromisesForRealPrograms) {
  if (!std::filesystem::is_directory(corpus_folder())) {
    GTEST_SKIP() << "no programs in " << corpus_folder() << " (set BATTEN_CORPUS)";
  }
  int programs = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(corpus_folder())) {
    if (entry.is_regular_file() && entry.path().extension() != ".md") {
      ASSERT_EQ(promises::broken_by(bytes_of(entry.path())), "") << entry.path();
      ++programs;
    }
  }
  EXPECT_GT(programs, 0);
}

}  // namespace
}  // namespace batten::gcode
