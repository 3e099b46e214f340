#include "gcode/interpreter/lost_modes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/support/interpreted.h"

namespace batten::gcode {
namespace {

constexpr const char* kKnownModes = "G21 G90 G94 G17 G40 G49 G64\nG54\nG0 X1 Y1 Z1\nG1 X2 F100\n";

// The message of the warning; empty where there is none.
std::string lost_modes_told(const std::string& text) {
  const tests::Interpreted it(text);
  const auto found = std::ranges::find(it.found, "modes-unknown", &Diagnostic::id);
  return found == it.found.end() ? "" : found->message;
}

TEST(LostModes, AreToldWithTheBlockThatLostThem) {
  const std::string unknown =
      lost_modes_told(std::string(kKnownModes) + "G777 (odd)\nX3\nY4\nM3\n");
  EXPECT_NE(unknown.find("behind 'G777 (odd)' is not known, so 2 blocks with X, Y or Z are copied"),
            std::string::npos)
      << unknown;
  EXPECT_EQ(unknown.find("--allow"), std::string::npos);
  const std::string call = lost_modes_told(std::string(kKnownModes) + "M98 P1000\nX3\n");
  EXPECT_NE(call.find("so 1 block with X, Y or Z is copied"), std::string::npos) << call;
}

TEST(LostModes, AreToldOfCallsWithTheOptionThatLiftsThem) {
  const std::string call = lost_modes_told(std::string(kKnownModes) + "o100 call\nX3\nX4\n");
  EXPECT_NE(call.find("--allow subprogram"), std::string::npos) << call;
}

TEST(LostModes, AreNotToldWhereNothingIsCopiedForThem) {
  EXPECT_EQ(lost_modes_told(std::string(kKnownModes) + "X3\nM30\n"), "");
  EXPECT_EQ(lost_modes_told(std::string(kKnownModes) + "G777\nM30\n"), "");
  EXPECT_EQ(lost_modes_told("G1 X1\nG21\nG0 X1\n"), "");  // units-missing says that
}

}  // namespace
}  // namespace batten::gcode
