// Blocks of X, Y and Z alone have a way of their own through the interpreter: they mean what the
// same blocks mean that take the common way, because they have a number or a comment as well.
#include "gcode/interpreter/plain_line.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

using tests::Interpreted;

void expect_same_motion(const Motion& plain, const Motion& common) {
  EXPECT_EQ(plain.block, common.block);
  EXPECT_EQ(plain.kind, common.kind);
  EXPECT_EQ(plain.start_known, common.start_known);
  EXPECT_EQ(plain.end_known, common.end_known);
  EXPECT_EQ(plain.axes_named, common.axes_named);
  EXPECT_EQ(geometry::start_point(plain.piece), geometry::start_point(common.piece));
  EXPECT_EQ(geometry::end_point(plain.piece), geometry::end_point(common.piece));
}

void expect_same(const std::vector<std::string>& lines) {
  std::string plain;
  std::string common;
  for (const std::string& line : lines) {
    plain += line + "\n";
    common += line + " ()\n";
  }
  SCOPED_TRACE(plain);
  const Interpreted a(plain);
  const Interpreted b(common);
  ASSERT_EQ(a.read.motions.size(), b.read.motions.size());
  for (std::size_t i = 0; i < a.read.motions.size(); ++i) {
    expect_same_motion(a.read.motions[i], b.read.motions[i]);
  }
  ASSERT_EQ(a.read.blocks.size(), b.read.blocks.size());
  for (std::size_t i = 0; i < a.read.blocks.size(); ++i) {
    SCOPED_TRACE(testing::Message() << "line " << i + 1);
    EXPECT_EQ(a.read.blocks[i].kind, b.read.blocks[i].kind);
    EXPECT_EQ(a.read.blocks[i].barrier, b.read.blocks[i].barrier);
    EXPECT_EQ(a.read.blocks[i].motion, b.read.blocks[i].motion);
    EXPECT_EQ(a.read.blocks[i].state_after, b.read.blocks[i].state_after);
  }
  EXPECT_EQ(a.read.states, b.read.states);
  EXPECT_EQ(a.found.size(), b.found.size());
}

TEST(PlainLines, MeanWhatTheyMeanBesideAComment) {
  // Among them words that end the plain way: arcs, increments, polar words, cycles, a jump, a word
  // twice, places that are not known yet, inches.
  const std::vector<std::string> kinds = {
      "X1",     "Y2.5",           "Z-1",     "X1 Y2", "X3 Z1",  "X1 Y1 Z1", "X.5 X2",     "G1",
      "G0",     "G2 X1 Y1 I1 J0", "G91",     "G90",   "G16",    "G15",      "G81 Z-1 R1", "G80",
      "M98 P2", "F100",           "X1 F200", "G20",   "G21",    "N7 X4",    "GOTO 7",     "/X9",
      "X1 Y#1", "G92 X0",         "M3",      "X1 A5", "G28 X0", "T1 M6",    "Y3"};
  for (unsigned seed = 0; seed < 300; ++seed) {
    std::mt19937 random(seed);
    std::uniform_int_distribution<std::size_t> any(0, kinds.size() - 1);
    std::uniform_int_distribution<std::size_t> place(0, 5);
    std::vector<std::string> lines = {"G21 G90", "G1 F1000"};
    for (int i = 0; i < 24; ++i) lines.push_back(kinds[i % 3 == 0 ? any(random) : place(random)]);
    expect_same(lines);
    if (testing::Test::HasFailure()) return;
  }
}

TEST(PlainLines, AnAxisIsKnownFromItsFirstWordOn) {
  const Interpreted it("G21 G1 F100\nX1\nX2\nX3 Y1\nX4 Y2\n");
  EXPECT_FALSE(it.motion_of_line(2)->start_known);
  EXPECT_TRUE(it.motion_of_line(3)->start_known);
  EXPECT_FALSE(it.motion_of_line(4)->start_known);
  EXPECT_TRUE(it.motion_of_line(5)->start_known);
}

}  // namespace
}  // namespace batten::gcode
