#include "gcode/reading/dropped_words.h"

#include <gtest/gtest.h>

namespace batten::gcode {
namespace {

struct DropCase {
  const char* name;
  const char* drop;
  const char* before;
  const char* after;
};

class DroppedWords : public testing::TestWithParam<DropCase> {};

TEST_P(DroppedWords, GoAloneAndOnlyWhereItIsCertainWhatGoes) {
  const DropCase& test = GetParam();
  std::size_t dropped = 0;
  const SourceText source("part.nc", test.before);
  EXPECT_EQ(without_words(source, {test.drop}, dropped).text(), test.after);
  EXPECT_EQ(dropped > 0, std::string(test.before) != test.after);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, DroppedWords,
    testing::Values(
        DropCase{"AmongOthers", "G64", "G21 G64 P0.01 Q.02 G90\r\nX1\r\n", "G21 G90\r\nX1\r\n"},
        DropCase{"OwnLine", "G64", "N10 G64P.01 (blend)\nX1\n", "N10 (blend)\nX1\n"},
        DropCase{"NothingElse", "G64", "g64 p0\nX1", "\nX1"},
        DropCase{"Bare", "G64", "G0 X1 G64 M3\n", "G0 X1 M3\n"},
        DropCase{"HighSpeedMode", "G5.1", "G05.1 Q1\nX1\nG5.1 Q0\n", "\nX1\n\n"},
        DropCase{"HighSpeedP", "G5", "G05 P10000\nX1\nG5 P0\n", "\nX1\n\n"},
        DropCase{"Smoothness", "G187", "G187 P3 E0.1\nX1\nG187\n", "\nX1\n\n"},
        // What would be harmed: a dwell that loses its time, a drilling depth, a call.
        DropCase{"BesideADwell", "G64", "G64 G4 P2\n", "G64 G4 P2\n"},
        DropCase{"BesideACycle", "G64", "G64 G81 X1 Z-2 R1\n", "G64 G81 X1 Z-2 R1\n"},
        DropCase{"BesideACall", "G64", "G64 M98 P100\n", "G64 M98 P100\n"},
        // An arc by its radius: R is not the blending's.
        DropCase{"BesideAnArc", "G64", "G64 G2 X1 R1\n", "G64 G2 X1 R1\n"},
        // Curves with the same codes.
        DropCase{"CubicCurve", "G5", "G5 X1 Y1 I1 J1 P1 Q1\n", "G5 X1 Y1 I1 J1 P1 Q1\n"},
        DropCase{"CurveThatGoesOn", "G5", "G5\n", "G5\n"},
        DropCase{"QuadraticCurve", "G5.1", "G5.1 X1 Y1 I1\n", "G5.1 X1 Y1 I1\n"},
        // An exact stop or a tapping mode that would never end.
        DropCase{"AfterExactStop", "G64", "G61\nX1\nG64 P.01\n", "G61\nX1\nG64 P.01\n"},
        DropCase{"AfterTapping", "G64", "G63\nZ1\nG64\n", "G63\nZ1\nG64\n"},
        DropCase{"InAComment", "G64", "(G64 P.01)\n", "(G64 P.01)\n"},
        DropCase{"AnotherCode", "G64", "G54 G640\n", "G54 G640\n"},
        DropCase{"AnExpression", "G64", "G64 P#1\n", "G64 P#1\n"},
        DropCase{"BlockDelete", "G64", "/G64 P1\n", "/G64 P1\n"},
        DropCase{"CheckSum", "G64", "N1 G64*90\n", "N1 G64*90\n"},
        DropCase{"Siemens", "G64", "%_N_A_MPF\nG64\n", "%_N_A_MPF\nG64\n"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace batten::gcode
