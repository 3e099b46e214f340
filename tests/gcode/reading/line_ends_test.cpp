// Lines as LinuxCNC reads them: what its rs274 (2.9) made of each mixture of line ends and NULs. A
// line ends at LF; a CR is left out wherever it stands, also within a number; a NUL hides what
// stands behind it in its line. What a reader that ends lines at CR, too, would take for something
// else is not read.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

using Ends = std::vector<std::pair<double, double>>;  // X and Y of each motion

enum class Read { kAll, kUpToThere };  // all motions; those before the line that is not read

struct LineEndCase {
  std::string text;
  Ends linuxcnc;  // the motions of its rs274, up to its error where it gave one
  Read read = Read::kAll;
};

std::string five_lines(const std::string& end) {
  std::string text;
  for (const char* line : {"G21 G90 F3000", "G0 X0 Y0", "G1 X60", "G1 Y60", "M2"})
    text += line + end;
  return text;
}

std::string with_line(const std::string& line) {
  return "G21 G90 F3000\nG0 X0 Y0\n" + line + "\nG1 X5 Y5\nM2\n";
}

const Ends kFive = {{0, 0}, {60, 0}, {60, 60}};

const LineEndCase kLineEndsRows[] = {

    // Of whole programs
    {five_lines("\n"), kFive},
    {five_lines("\r\n"), kFive},
    {five_lines("\r\r\n"), kFive},
    {five_lines("\n\r"), kFive},
    {five_lines("\n").substr(0, 39), kFive},
    {five_lines("\n") + "\r", kFive},
    // "Two g codes used from same modal group": all of it is one line.
    {five_lines("\r"), {}, Read::kUpToThere},

    // Of one line
    {with_line("\rG1 X60"), {{0, 0}, {60, 0}, {5, 5}}},
    {with_line("G1 X60\r"), {{0, 0}, {60, 0}, {5, 5}}},
    {with_line("G1 X60\rY60"), {{0, 0}, {60, 60}, {5, 5}}, Read::kUpToThere},
    // "Two g codes used from same modal group"
    {with_line("G1 X60\rG1 Y60"), {{0, 0}}, Read::kUpToThere},
    {with_line("G1 X6\r0"), {{0, 0}, {60, 0}, {5, 5}}, Read::kUpToThere},
    {with_line("(a\rX5) G1 X60"), {{0, 0}, {60, 0}, {5, 5}}, Read::kUpToThere},
    {with_line("G1 X60 ; a\rX5"), {{0, 0}, {60, 0}, {5, 5}}, Read::kUpToThere},
    {with_line(std::string("\0G1 X60", 7)), {{0, 0}, {5, 5}}, Read::kUpToThere},
    {with_line(std::string("G1 X60\0Y60", 10)), {{0, 0}, {60, 0}, {5, 5}}, Read::kUpToThere},
    {with_line(std::string("G1 X60\0", 7)), {{0, 0}, {60, 0}, {5, 5}}, Read::kUpToThere},
    {with_line(std::string("\0\0\0", 3)), {{0, 0}, {5, 5}}}};

TEST(LineEnds, AreReadAsByLinuxCncOrNotAtAll) {
  for (const LineEndCase& test : kLineEndsRows) {
    SCOPED_TRACE(test.text);
    const tests::Interpreted it(test.text);
    Ends ends;
    for (const Motion& motion : it.read.motions) {
      if (motion.start_known || ends.empty()) {
        ends.emplace_back(motion.piece.end().x(), motion.piece.end().y());
      }
    }
    const Ends& theirs = test.linuxcnc;
    if (test.read == Read::kAll) {
      EXPECT_EQ(ends, theirs);
      continue;
    }
    EXPECT_TRUE(it.has_diagnostic("unreadable-block"));
    ASSERT_LE(ends.size(), theirs.size());
    EXPECT_TRUE(std::equal(ends.begin(), ends.end(), theirs.begin()));
  }
}

}  // namespace
}  // namespace batten::gcode
