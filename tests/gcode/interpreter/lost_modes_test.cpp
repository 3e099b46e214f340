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
  EXPECT_NE(unknown.find("--word"), std::string::npos);
  const std::string call = lost_modes_told(std::string(kKnownModes) + "M98 P1000\nX3\n");
  EXPECT_NE(call.find("so 1 block with X, Y or Z is copied"), std::string::npos) << call;
}

TEST(LostModes, AreToldOfCallsWithTheOptionThatLiftsThem) {
  const std::string call = lost_modes_told(std::string(kKnownModes) + "o100 call\nX3\nX4\n");
  EXPECT_NE(call.find("--allow subprogram"), std::string::npos) << call;
}

// What the message names is what is missing, no more and no less.
TEST(LostModes, AreToldWithTheWordsThatWereNotSaidAgain) {
  const std::string text = std::string(kKnownModes) + "G777\nG90 G94 G40 G49\nX3\nG17\nX4\nM30\n";
  EXPECT_NE(lost_modes_told(text).find(
                "not set again before the last of them: units (G20 or G21), centres of arcs "
                "(G91.1), path mode (G64), tilted plane (G69), scaling (G50), rotation (G69), "
                "mirroring (G50.1), polar coordinates (G15), cylindrical coordinates (G7.1 C0), "
                "smoothing by the control (G5.1 Q0), modal macro (G67), constant surface speed "
                "(G97), diameter mode (G8). Set these after it"),
            std::string::npos)
      << lost_modes_told(text);
}

TEST(LostModes, AreNotToldWhereNothingIsCopiedForThem) {
  EXPECT_EQ(lost_modes_told(std::string(kKnownModes) + "X3\nM30\n"), "");
  EXPECT_EQ(lost_modes_told(std::string(kKnownModes) + "G777\nM30\n"), "");
  EXPECT_EQ(lost_modes_told("G1 X1\nG21\nG0 X1\n"), "");  // units-missing says that
}

}  // namespace
}  // namespace batten::gcode
