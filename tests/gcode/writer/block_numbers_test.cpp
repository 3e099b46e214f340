#include "gcode/writer/block_numbers.h"

#include <gtest/gtest.h>

#include "tests/support/klartext_programs.h"

namespace batten::postproc {
namespace {

TEST(BlockNumbers, ReachFromTheFirstReplacedToTheNextOne) {
  const tests::KlartextProgram p("4 L X+1\n5 L X+2\n6 L X+3\n9 L X+4\n");
  const LineNumberRange room = number_room(p.program, 1, 2);
  EXPECT_EQ(room.first, 5U);
  EXPECT_EQ(room.blocks, 4U);
}

TEST(BlockNumbers, HaveNoEndBehindTheLastBlock) {
  const tests::KlartextProgram p("4 L X+1\n5 L X+2\n");
  EXPECT_EQ(number_room(p.program, 0, 1).first, 4U);
  EXPECT_EQ(number_room(p.program, 0, 1).blocks, LineNumberRange().blocks);
}

TEST(BlockNumbers, AreNotAddedWhereThereAreNone) {
  const tests::KlartextProgram p("L X+1\nL X+2\n");
  EXPECT_EQ(number_room(p.program, 0, 1).first, std::nullopt);
}

// N words of other languages are labels; new blocks have none.
TEST(BlockNumbers, OfOtherLanguagesDoNotCount) {
  gcode::Diagnostics found;
  const gcode::Program p = gcode::parse(gcode::SourceText("a.nc", "N1 G1 X1\nN2 X2\n"), found);
  EXPECT_EQ(number_room(p, 0, 1).first, std::nullopt);
}

TEST(BlockNumbers, StandBeforeBlocksAndNotBeforeTheirLines) {
  const std::string text = "SPL X+1 Y+1 ~\n  K3X+0 ~\n  K3Y+0\r\nL X+5\n";
  EXPECT_EQ(numbered_lines(text), 2U);
  const std::string numbered = with_numbers(text, 8);
  EXPECT_EQ(numbered, "8 SPL X+1 Y+1 ~\n  K3X+0 ~\n  K3Y+0\r\n9 L X+5\n");
  EXPECT_EQ(with_numbers(numbered, 11), "11 SPL X+1 Y+1 ~\n  K3X+0 ~\n  K3Y+0\r\n12 L X+5\n");
}

}  // namespace
}  // namespace batten::postproc
