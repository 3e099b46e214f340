// Where runs end that have to keep different tolerances.
#include <gtest/gtest.h>

#include <string>
#include <variant>
#include <vector>

#include "gcode/state/reason.h"
#include "postproc/runs/run_cutting.h"
#include "postproc/runs/run_grouping.h"
#include "tests/support/interpreted.h"

namespace batten::postproc {
namespace {

// "3-5 0.01; 7-9 0.005": lines of the runs and what they have to keep, of 0.01 mm.
std::string runs_in(const std::string& text) {
  const tests::Interpreted it(text);
  std::string found;
  for (const Section& section : group_runs(it.program, it.read, {})) {
    const Run* run = std::get_if<Run>(&section.content);
    const auto* copied = std::get_if<Verbatim>(&section.content);
    const bool told = run != nullptr || copied->reason == gcode::reason::kStatedTolerance;
    if (!told) continue;
    found += found.empty() ? "" : "; ";
    found += std::to_string(section.first_block + 1) + "-" + std::to_string(section.last_block + 1);
    found += run != nullptr ? " " + std::to_string(tolerance_of(*run, 0.01)).substr(0, 5)
                            : " " + std::string(copied->reason);
  }
  return found;
}

const std::string kHead = "G21 G90 G17 G94\nG0 X0 Y0 Z0\n";
const std::string kMoves = "G1 X1 Y1 F100\nX2 Y0\nX3 Y1\n";
const std::string kMore = "X4 Y0\nX5 Y1\nX6 Y0\n";

TEST(RunsOfStatedTolerances, EndWhereItChanges) {
  EXPECT_EQ(runs_in(kHead + kMoves + kMore), "3-8 0.010");
  EXPECT_EQ(runs_in(kHead + kMoves + "(TOLERANCE 0.005)\n" + kMore), "3-5 0.010; 7-9 0.005");
  EXPECT_EQ(runs_in(kHead + "(TOL 0.002)\n" + kMoves + "(TOLERANCE 0.005)\n" + kMore),
            "4-6 0.002; 8-10 0.005");
  // It says the same again.
  EXPECT_EQ(runs_in(kHead + "(TOL 0.005)\n" + kMoves + "(TOLERANCE 0.005)\n" + kMore),
            "4-10 0.005");
}

TEST(RunsOfStatedTolerances, GoOnWhereItChangesAboveThatOfTheUser) {
  EXPECT_EQ(runs_in(kHead + "(TOL 0.02)\n" + kMoves + "(TOLERANCE 0.05)\n" + kMore), "4-10 0.010");
  EXPECT_EQ(runs_in(kHead + kMoves + "(TOLERANCE 0.01)\n" + kMore), "3-9 0.010");
}

TEST(RunsOfStatedTolerances, LeaveAMoveBesideItAsItIs) {
  EXPECT_EQ(runs_in(kHead + kMoves + "X3.5 Y0.5 (TOLERANCE 0.005)\n" + kMore),
            "3-5 0.010; 6-6 stated-tolerance; 7-9 0.005");
  EXPECT_EQ(runs_in(kHead + kMoves + "X3.5 Y0.5 (TOLERANCE 0.05)\n" + kMore), "3-9 0.010");
}

TEST(RunsOfStatedTolerances, HandItToTheirPieces) {
  std::string text = kHead + "(TOL 0.005)\nG1 F100\n";
  for (int i = 1; i <= 60; ++i) text += "X" + std::to_string(i) + (i % 2 == 0 ? " Y0\n" : " Y1\n");
  const tests::Interpreted it(text);
  const std::vector<Section> sections = group_runs(it.program, it.read, {});
  const std::vector<RunPiece> pieces =
      cut_run(sections.back(), it.read, {.shortest = 10, .longest = 20});
  ASSERT_GT(pieces.size(), 1U);
  for (const RunPiece& piece : pieces) {
    EXPECT_EQ(tolerance_of(std::get<postproc::Run>(piece.section.content), 0.01), 0.005);
  }
}

}  // namespace
}  // namespace batten::postproc
