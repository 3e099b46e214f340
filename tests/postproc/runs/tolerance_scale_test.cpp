// A tolerance beside the part and the moves that it is for.
#include "postproc/runs/tolerance_scale.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "gcode/reading/parser.h"
#include "postproc/runs/run_grouping.h"

namespace batten::postproc {
namespace {

gcode::Diagnostics warnings_of(const std::string& moves, double tolerance_mm) {
  const std::string text = "G21 G90 G17 G94 G40\nG0 X-500 Y0 Z5\nG0 X0\nG1 Z0 F100\n" + moves;
  const gcode::SourceText source("test.nc", text);
  gcode::Diagnostics found;
  const gcode::Program program = gcode::parse(source, found);
  const gcode::Interpretation read = gcode::interpret(program, {}, found);
  ToleranceScale scale(tolerance_mm);
  scale.add(program, read, group_runs(program, read, {}));
  return scale.diagnostics();
}

std::vector<std::string> ids_of(const gcode::Diagnostics& found) {
  std::vector<std::string> ids;
  for (const gcode::Diagnostic& each : found) ids.emplace_back(each.id);
  return ids;
}

using Ids = std::vector<std::string>;

// The rapid from X-500 is no part of it.
constexpr char kTenMillimetres[] = "G1 X2 Y0.1\nX4 Y0\nX6 Y0.1\nX8 Y0\nX10 Y0.1\n";

TEST(ToleranceScale, WarnsAboveAHundredthOfThePart) {
  EXPECT_EQ(ids_of(warnings_of(kTenMillimetres, 0.1)), Ids{});
  const gcode::Diagnostics found = warnings_of(kTenMillimetres, 0.101);
  ASSERT_EQ(ids_of(found), Ids{"tolerance-large"});
  EXPECT_EQ(found[0].severity, gcode::Severity::kWarning);
  EXPECT_NE(found[0].message.find("0.101 mm"), std::string::npos) << found[0].message;
  EXPECT_NE(found[0].message.find("10.000 x 0.100 x 5.000 mm"), std::string::npos)
      << found[0].message;
}

// A full circle of radius 10 begins where it ends; the run on it is small.
TEST(ToleranceScale, KnowsThatArcsReachBeyondTheirEnds) {
  const std::string run = "G1 X0.4\nX0.8 Y0.1\nX1.2\nX1.6 Y0.2\n";
  EXPECT_EQ(ids_of(warnings_of("G2 I10 J0\n" + run, 0.19)), Ids{});
  EXPECT_EQ(ids_of(warnings_of(run, 0.19)), Ids{"tolerance-large"});
}

// Moves of 0.5, 0.5, 1, 1, 1 mm, then 100 mm away one of 200 mm that is no run by itself.
TEST(ToleranceScale, WarnsAboveTheMedianOfTheMovesInRuns) {
  const std::string moves = "G1 X0.5\nX1\nX2\nX3\nX4\nG0 Z5\nG0 X100\nG1 Z0\nG1 X300\n";
  EXPECT_EQ(ids_of(warnings_of(moves, 0.9)), Ids{});
  const gcode::Diagnostics found = warnings_of(moves, 1.1);
  ASSERT_EQ(ids_of(found), Ids{"tolerance-above-chords"});
  EXPECT_NE(found[0].message.find("5 of the 5 moves"), std::string::npos) << found[0].message;
}

TEST(ToleranceScale, SaysNothingWhereNothingMayBeSmoothed) {
  EXPECT_EQ(ids_of(warnings_of("G91\nG1 X1\nX1\nX1\nX1\n", 50)), Ids{});
  EXPECT_EQ(ids_of(warnings_of("", 50)), Ids{});
}

TEST(ToleranceScale, OfPartsIsThatOfTheWhole) {
  const gcode::SourceText source("test.nc",
                                 "G21 G90 G17 G94 G40\nG0 X0 Y0 Z0\nF100\nG1 X1\nX2\nX3\nX4\n");
  const gcode::SourceText far("far.nc",
                              "G21 G90 G17 G94 G40\nG0 X90 Y0 Z0\nF100\nG1 X91\nX92\nX93\nX94\n");
  ToleranceScale together(0.5);
  for (const gcode::SourceText* each : {&source, &far}) {
    gcode::Diagnostics found;
    const gcode::Program program = gcode::parse(*each, found);
    const gcode::Interpretation read = gcode::interpret(program, {}, found);
    ToleranceScale part(0.5);
    part.add(program, read, group_runs(program, read, {}));
    EXPECT_EQ(ids_of(part.diagnostics()), Ids{"tolerance-large"});
    together.add(part);
  }
  EXPECT_EQ(ids_of(together.diagnostics()), Ids{});
}

}  // namespace
}  // namespace batten::postproc
