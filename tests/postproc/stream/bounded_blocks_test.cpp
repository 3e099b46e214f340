// A block that is not understood, in the midst of a program: what is behind it is smoothed only
// where the block cannot have changed what it means, or where that was said again.
#include <gtest/gtest.h>

#include <string>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

struct BoundedRow {
  const char* block;
  bool smoothed_behind;
};

const BoundedRow kBoundedRows[] = {
    {"[SECOND PASS]", true},
    {"$X", true},
    {"$H", true},
    {"$110=500", true},
    {"M117 Layer 2/3", true},
    {"M55", true},
    {"M101", true},
    {"X1 X2", true},
    {"F100 F200", true},
    {"M3 M5", true},
    {"G90 G91\nG90", true},
    {"G93 G94\nG94", true},
    {"G40 G41 D1\nG40", true},
    {"G17 G18\nG17", true},
    // The wave would be cut in increments, beside itself, in another plane, by the inverse of time,
    // with stops at each point, by a macro, in other units.
    {"G90 G91", false},
    {"X1 X2 G91", false},
    {"G40 G41 D1", false},
    {"G17 G18", false},
    {"G93 G94", false},
    {"G61.1 G64", false},
    {"G20 G21", false},
    {"G20 G21\nG91 G90\nG90", false},
    {"G90 G91 G777\nG90", false},
    {"START_PRINT", false},
    {"part.nc", false},
    {"$J=G91 X1 F9", false},
    {"[SECOND PASS] G91", false},
    {"G777", false},
    {"M98 P1", false},
    {"L54", false},  // a subprogram of Sinumerik
};

TEST(BoundedBlocks, LoseOnlyWhatTheyCanHaveChanged) {
  const std::string wave = joined(wave_lines({}), "\n");
  for (const BoundedRow& row : kBoundedRows) {
    SCOPED_TRACE(row.block);
    const std::string text = head("G21") + "G94 G40 G64\n" + wave + "G0 Z5\n" + row.block +
                             "\nG0 X0 Y0 Z5\nG1 Z-1 F300\n" + wave + tail();
    const SmoothResult result = smoothed(text, options_for("grbl"));
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result), row.smoothed_behind ? 2U : 1U);
  }
}

// Of words that exclude each other the control may have taken either, or none: the same word behind
// them is no repetition.
TEST(BoundedBlocks, AreNoReasonToLeaveOutTheWordThatSettlesThem) {
  for (const std::string& word : {std::string("G41"), std::string("G40")}) {
    SCOPED_TRACE(word);
    const std::string begin = head("G21") + "G40\nG40 G41 D1\n";
    const std::string end = "G0 X0 Y0\nG1 X5 Y5 F100\nX9\n" + tail();
    const ReadText with(begin + word + "\n" + end);
    const ReadText without(begin + end);
    const auto proved =
        verify({&with.program, &with.meaning}, {&without.program, &without.meaning}, 0.01).proved();
    EXPECT_FALSE(proved);
  }
}

}  // namespace
}  // namespace batten::postproc
