// Simple lines are read and followed in a short way. It changes nothing: for any line the words,
// values, places, motions and states are those of the common way, bit for bit.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "gcode/reading/part_reading.h"
#include "gcode/rs274/plain_words.h"

namespace batten::gcode {
namespace {

class RandomLines {
 public:
  // `tame`: lines that leave the state known, so that the short way is taken again and again.
  RandomLines(unsigned seed, bool tame) : random_(seed), tame_(tame) {}

  std::string program(int lines) {
    std::string text;
    for (int i = 0; i < lines; ++i) text += line() + any({"\n", "\n", "\n", "\r\n", "\r", "\n\n"});
    return one_in(3) ? text + line() : text;
  }

 private:
  unsigned below(unsigned many) { return static_cast<unsigned>(random_() % many); }
  bool one_in(unsigned many) { return below(many) == 0; }
  std::string any(const std::vector<std::string>& texts) { return texts[random_() % texts.size()]; }
  std::string digits(unsigned most) {
    std::string text;
    for (unsigned left = below(most + 1); left > 0; --left) {
      text.push_back(static_cast<char>('0' + random_() % 10));
    }
    return text;
  }

  // Few digits as a rule; up to twenty on either side of the point, or none.
  std::string number() {
    const unsigned most = one_in(6) ? 20 : 4;
    std::string text =
        any({"", "", "", "-", "-", "+"}) + any({"", "", "", "0", "00"}) + digits(most);
    if (!one_in(4)) text += "." + digits(most);
    if (one_in(8)) return any({"0", "-0", "1", "-0.000", ".5", "5.", "."});
    if (one_in(30)) text.insert(random_() % (text.size() + 1), any({" ", "\t", "#", "[", "."}));
    return text;
  }

  std::string tame_number() {
    return any({"", "", "-"}) + "1" + digits(3) + any({"", ".", ".5", ".25"});
  }

  // Each word once, but now and then.
  std::string tame_line() {
    if (one_in(12)) {
      return any({"", "(a comment)", "M8", "G81 X1 Z-1 R1", "G80", "G20", "G21", "G90 G94", "G93",
                  "G99", "F5"});
    }
    std::vector<std::string> words;
    if (one_in(4)) words.push_back("N" + digits(3) + "1");
    if (one_in(3)) words.push_back(any({"G1", "G0", "G01", "G1.", "g1", "G91"}));
    for (const char* letter : {"X", "Y", "Z"}) {
      if (!one_in(3)) words.push_back(letter + tame_number());
    }
    if (one_in(4)) words.push_back(any({"F", "f"}) + any({"100.", "250", "0", "-1", "1.5"}));
    if (one_in(40)) words.push_back("X2");
    if (one_in(4)) std::shuffle(words.begin(), words.end(), random_);
    std::string text;
    for (const std::string& word : words) text += word + any({"", " ", " ", "\t"});
    return text;
  }

  std::string word() {
    if (one_in(6)) {
      return any({"G1",  "G0",     "G01", "g0",  "G 1", "G1.0",   "G2",  "G90",
                  "G91", "G20",    "G21", "G94", "G93", "G16",    "G15", "G80",
                  "M3",  "M98 P7", "M30", "T1",  "N7",  "GOTO 7", "O5"});
    }
    std::string text = any({"X", "X", "X", "Y", "Y", "Z", "Z", "x", "z", "N", "F", "F", "I", "E",
                            "e", "A", "S", "R", "O"});
    if (one_in(30)) text += " ";
    return text + number();
  }

  std::string line() {
    if (tame_) return tame_line();
    if (one_in(40)) {
      return any({"", "  ", "%", "(a comment)", "; another", "/X1", "X", "=", "#1=5", "\t", "$",
                  std::string(1, '\0'), "\x1a", "DEF REAL A", "X1 (c) Y2", "X1 ; c", "N5*33"});
    }
    std::string text = any({"", "", "", " ", "N12 ", "N3"});
    for (unsigned left = 1 + below(4); left > 0; --left) {
      text += word() + any({"", " ", " ", "  ", "\t"});
    }
    if (one_in(40)) text.insert(random_() % (text.size() + 1), any({"E", "e3", "(x)", "_", ":"}));
    return text;
  }

  std::mt19937 random_;
  bool tame_;
};

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

// Whole contents as text, so that a difference shows itself.
std::string text_of(const Program& program) {
  std::string text;
  for (const Block& block : program.blocks) {
    text +=
        fmt::format("\n{} {}-{}-{} {} {}{} {}+{}:", block.line, block.span.begin, block.span.end,
                    block.end, static_cast<int>(block.opacity), block.block_delete,
                    block.has_checksum, block.first_word, block.first_comment);
    for (const Word& word : program.words_of(block)) {
      text += fmt::format(" {}{:x}.{}{}{}{}@{}-{}", word.letter, bits(word.value), word.decimals,
                          word.has_point, word.is_number, word.without_point, word.span.begin,
                          word.span.end);
    }
    text += fmt::format(" {}", program.comments_of(block).size());
  }
  return text;
}

std::string text_of(const geometry::Point3& place) {
  return fmt::format("{:x},{:x},{:x}", bits(place.x()), bits(place.y()), bits(place.z()));
}

std::string text_of(const Interpretation& read) {
  std::string text;
  for (const BlockMeaning& block : read.blocks) {
    text += fmt::format("\n{} '{}' {} {} {}{}{}", static_cast<int>(block.kind), block.barrier.id(),
                        block.motion, block.state_after, block.label_referenced,
                        block.entered_from_elsewhere, block.of_curve);
    if (block.motion < 0) continue;
    const Motion& motion = read.motions[static_cast<std::size_t>(block.motion)];
    text += fmt::format(" {} {} {}{} {}{}{} {} {}", motion.block, static_cast<int>(motion.kind),
                        motion.start_known, motion.end_known, motion.axes_named[0],
                        motion.axes_named[1], motion.axes_named[2], text_of(motion.piece.start()),
                        text_of(motion.piece.end()));
  }
  return text + fmt::format("\n{}", read.unit_word_seen);
}

std::string text_of(const Diagnostics& found) {
  std::string text;
  for (const Diagnostic& each : found) {
    text += fmt::format("\n{} {}-{} {}", each.id, each.where.begin, each.where.end, each.message);
  }
  return text;
}

struct Ways {
  Ways(const std::string& text, Reading reading, bool short_ways)
      : program(parse(SourceText("test.nc", text), with(reading, short_ways), found)),
        control(reading.units),
        read(interpret_part(program, {.units = reading.units, .short_ways = short_ways}, control,
                            found)) {
    finish_interpretation(control, found);
  }

  static Reading with(Reading reading, bool short_ways) {
    reading.short_ways = short_ways;
    return reading;
  }

  Diagnostics found;
  Program program;
  ControlCarry control;
  Interpretation read;
};

// Returns the words that were read.
std::size_t expect_same(const std::string& text, const Reading& reading) {
  SCOPED_TRACE(text);
  const Ways one(text, reading, true);
  const Ways other(text, reading, false);
  EXPECT_EQ(text_of(one.program), text_of(other.program));
  EXPECT_EQ(text_of(one.read), text_of(other.read));
  EXPECT_EQ(one.read.states, other.read.states);
  EXPECT_TRUE(one.control.state == other.control.state);
  EXPECT_EQ(text_of(one.found), text_of(other.found));
  return one.program.words.size();
}

TEST(ShortWays, ReadAndFollowRandomLinesAsTheCommonWaysDo) {
  constexpr unsigned kPrograms = 1500;
  std::size_t words = 0;
  for (unsigned seed = 0; seed < kPrograms; ++seed) {
    const bool tame = seed % 5 < 3;
    RandomLines lines(seed, tame);
    Reading reading;
    reading.units = seed % 3 == 0 ? Units::kInch : Units::kMillimetre;
    if (seed % 4 == 1) reading.decimals = {.pointless = PointlessNumbers::kUndeclared};
    if (seed % 4 == 2) reading.decimals = {.pointless = PointlessNumbers::kIncrements};
    const std::string begin = tame ? "G90 G1 F100.\n" : seed % 2 == 0 ? "G21 G1 F100\n" : "";
    words += expect_same(begin + lines.program(30), reading);
    ASSERT_FALSE(testing::Test::HasFailure()) << "seed " << seed;
  }
  EXPECT_GT(words, 20U * kPrograms) << "hardly any line was one of words";
}

// The promise above says nothing where the short way is never taken.
TEST(ShortWays, AreTakenByLinesOfPlainWords) {
  for (const std::string line :
       {"X1.234 Y-5.678", "N10 G1 X+.5 Z-7. F1500", "x1y2z3", "", "  G0  Z5\t", "E1 X2", "X1 E2",
        "X123456789.012345", "X-0", "M3 S12000"}) {
    for (const std::string end : {"", "\n", "\r\n", "\nX9"}) {
      std::vector<Word> words;
      const auto read = read_plain_words("G9\n" + line + end, 3, words);
      ASSERT_TRUE(read) << line << end;
      EXPECT_EQ(read->text_end, 3 + line.size());
      EXPECT_EQ(read->end, 3 + line.size() + (end == "\r\n" ? 2 : end.empty() ? 0 : 1));
    }
  }
}

TEST(ShortWays, LeaveOtherLinesToTheCommonWay) {
  std::istringstream table(
      "X|X-|X.|X1 2|X1 .5|X1.2.3|X 1|X- 1|X1E3|X1e3|O5|o5|%|(c)|X1;|X#1|X[1]|/X1|X1=2|X1:|"
      "N5*33|1|XY1|X1234567890|X0.0000000000000001|X1\r|X1\rY2|\xEF\xBB\xBFX1");
  for (std::string line; std::getline(table, line, '|');) {
    std::vector<Word> words(1);
    EXPECT_FALSE(read_plain_words(line, 0, words)) << line;
    EXPECT_EQ(words.size(), 1U) << line;
  }
}

}  // namespace
}  // namespace batten::gcode
