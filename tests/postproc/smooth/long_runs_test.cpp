// Runs that are too long to be held as one are cut into runs for themselves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <variant>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "postproc/runs/section.h"
#include "postproc/smooth/part_runs.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr int kMotions = 210000;

ProgramPart long_part() {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 X0.1 F2000\n";
  for (int i = 2; i <= kMotions; ++i) {
    text += fmt::format("X{:.1f} Y{:.3f}\n", 0.1 * i, 2 * std::sin(0.01 * i));
  }
  text += "G0 Z5\nM2\n";
  gcode::Diagnostics found;
  gcode::Program program = gcode::parse(gcode::SourceText("long.nc", text), found);
  gcode::Interpretation meaning = gcode::interpret(program, {}, found);
  return {std::move(program), std::move(meaning), {}};
}

TEST(LongRuns, AreCutIntoRunsThatCoverAllBlocks) {
  const ProgramPart part = long_part();
  const PartRuns runs = find_runs(part, options_for("linuxcnc"));
  EXPECT_GE(runs.works.size(), 5U);
  std::uint32_t next = 0;
  std::size_t motions = 0;
  for (const Section& section : runs.sections) {
    EXPECT_EQ(section.first_block, next);
    next = section.last_block + 1;
    const auto* run = std::get_if<postproc::Run>(&section.content);
    if (run == nullptr) continue;
    EXPECT_LE(run->points.size(), 50001U);
    motions += run->points.size() - 1;
  }
  EXPECT_EQ(next, part.program.blocks.size());
  EXPECT_EQ(motions, static_cast<std::size_t>(kMotions));
}

// What is only copied is held piece by piece too.
TEST(LongRuns, AreCutAtTheSamePlacesWhereNothingIsAsked) {
  SmoothOptions options = options_for("linuxcnc");
  const PartRuns smoothed = find_runs(long_part(), options);
  options.method = Method::kNone;
  const PartRuns copied = find_runs(long_part(), options);
  ASSERT_EQ(copied.works.size(), smoothed.works.size());
  EXPECT_GT(copied.works.size(), 1U);
  for (std::size_t i = 0; i < copied.sections.size(); ++i) {
    EXPECT_EQ(copied.sections[i].first_block, smoothed.sections[i].first_block);
  }
}

// A part in space, of which nothing but lines can be made, and one in a plane that is arcs.
TEST(LongRuns, OfLinesAloneAreCutForPartsThatAreArcs) {
  std::string text = "G21 G90 G17 G64 P0.01\nG0 X0 Y0 Z0\nF2000\n";
  for (int i = 1; i <= 700; ++i) {
    text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", 0.3 * i, 3 * std::sin(0.1 * i),
                        2 * std::sin(0.071 * i));
  }
  const double x = 210;
  const double y = 3 * std::sin(70);
  const double z = 2 * std::sin(0.071 * 700);
  for (int i = 1; i <= 300; ++i) {
    const double angle = 0.02 * i;
    text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", x + 20 * std::sin(angle),
                        y + 20 * (1 - std::cos(angle)), z);
  }
  const SmoothResult result = smoothed(text + "G0 Z5\nM2\n", options_for("linuxcnc"));
  EXPECT_TRUE(result.proved);
  EXPECT_GT(result.text.find("G3"), 0U);
  EXPECT_NE(result.text.find("G3"), std::string::npos);
}

PartRuns smoothed_runs(const std::string& text) {
  gcode::Diagnostics found;
  gcode::Program program = gcode::parse(gcode::SourceText("long.nc", text), found);
  gcode::Interpretation meaning = gcode::interpret(program, {}, found);
  const ProgramPart part{std::move(program), std::move(meaning), {}};
  const SmoothOptions options = options_for("linuxcnc");
  PartRuns runs = find_runs(part, options);
  EXPECT_TRUE(smooth_runs(
      part, options, [](double) { return true; }, runs));
  return runs;
}

// Rows over a rough relief, joined at their ends: no piece of them comes out in few blocks, and
// nothing is smoothed as a whole before it is cut.
TEST(LongRuns, OfWhichPiecesTakeManyBlocksAreCutAtOnce) {
  std::string text = "G21 G90 G17 G64 P0.01\nG0 X0 Y0 Z0\nF2000\n";
  for (int row = 0; row < 60; ++row) {
    for (int i = 0; i <= 100; ++i) {
      const double x = 0.3 * (row % 2 == 0 ? i : 100 - i);
      const double z =
          0.4 * std::sin(1.3 * x) * std::cos(0.8 * row) + 0.2 * std::sin(2.9 * x + row);
      text += fmt::format("G1 X{:.3f} Y{:.3f} Z{:.3f}\n", x, 0.5 * row, z);
    }
  }
  const PartRuns at_once = smoothed_runs(text + "G0 Z5\nM2\n");
  ASSERT_EQ(at_once.cut_runs.size(), 1U);
  EXPECT_GE(at_once.cut_runs[0].pieces, 20U);
  EXPECT_FALSE(at_once.cut_runs[0].facts);
}

// A circle, which is a few arcs as a whole.
TEST(LongRuns, OfWhichPiecesTakeFewBlocksStayWhole) {
  std::string text = "G21 G90 G17 G64 P0.01\nG0 X50 Y0 Z0\nF2000\n";
  for (int i = 1; i <= 8000; ++i) {
    const double angle = 2 * geometry::kPi * i / 8000;
    text += fmt::format("G1 X{:.4f} Y{:.4f}\n", 50 * std::cos(angle), 50 * std::sin(angle));
  }
  const PartRuns whole = smoothed_runs(text + "G0 Z5\nM2\n");
  EXPECT_TRUE(whole.cut_runs.empty());
  ASSERT_EQ(whole.works.size(), 1U);
  ASSERT_NE(whole.works[0].chosen(), nullptr);
  EXPECT_LE(whole.works[0].chosen()->figures.blocks, 10);
}

}  // namespace
}  // namespace batten::postproc
