// What keeps cutting moves, by the block that caused it.
#include "postproc/runs/kept_causes.h"

#include <gtest/gtest.h>

#include <string>

#include "gcode/reading/parser.h"
#include "gcode/reading/part_reading.h"
#include "gcode/state/reason.h"

namespace batten::postproc {
namespace {

namespace reason = gcode::reason;

constexpr char kBegin[] = "G21 G90 G17 G94 G40\nG0 X0 Y0 Z0\nF100\n";

// Of a program as a whole, or of two parts that are counted for themselves.
KeptCauses causes_of(const std::string& text, std::size_t blocks_of_first = 1000) {
  const gcode::SourceText source("test.nc", text);
  gcode::Diagnostics found;
  gcode::TextCarry carry;
  gcode::ControlCarry control(gcode::Units::kUnknown);
  CauseTally all;
  for (std::size_t blocks = blocks_of_first;; blocks = 1000) {
    const gcode::Program part = gcode::parse_part(source, {.blocks = blocks}, carry, found);
    if (part.blocks.empty()) return all.causes();
    const gcode::Interpretation read = gcode::interpret_part(part, {}, control, found);
    CauseTally tally;
    tally.add(part, read, group_runs(part, read, {}), {});
    all.add(tally);
  }
}

struct CauseRow {
  const char* text;  // behind kBegin
  std::string_view reason;
  std::uint32_t line;
  std::uint32_t first_line;
  const char* block;
  double share;
};

const CauseRow kRows[] = {
    // 10 mm of 40.
    {"G1 X10\nX20\nX30\nG41 D1\nX40\n", reason::kCutterCompensation, 7, 8, "G41 D1", 0.25},
    {"G93\nG1 X10 F2\nG94\nF100\nG1 X20\nX30\nX40", reason::kInverseTime, 4, 5, "G93", 0.25},
    // In moves: one of four has no length.
    {"G1 X10\nX20\nX30\nX#5", reason::kExpression, 0, 7, "X#5", 0.25},
    {"G1 X10\nX20\nX30\nM98 P1\nG1 X40", reason::kStateUnknown, 7, 8, "M98 P1", 0.25},
    {"G1 X10\nX20\nX30\nG55\nX40", reason::kPositionUnknown, 7, 8, "G55", 0.25},
    // It lies in the moves.
    {"G1 X10\nX20\nX30\nG0 Y5\nG1 X40\n", reason::kTooShort, 0, 8, "G1 X40", 0.25},
    {"G94\nG1 X1 F7\nX2\nX3\n", "", 0, 0, "", 0},
};

TEST(KeptCauses, NameTheBlockThatKeepsTheMoves) {
  for (const CauseRow& row : kRows) {
    SCOPED_TRACE(row.text);
    const KeptCauses kept = causes_of(std::string(kBegin) + row.text);
    EXPECT_TRUE(kept.any_run);
    ASSERT_EQ(kept.causes.size(), std::string_view(row.reason).empty() ? 0U : 1U);
    if (kept.causes.empty()) continue;
    const KeptCause& cause = kept.causes[0];
    EXPECT_EQ(cause.reason, row.reason);
    EXPECT_EQ(cause.line, row.line);
    EXPECT_EQ(cause.first_line, row.first_line);
    EXPECT_EQ(cause.text, row.block);
    EXPECT_EQ(cause.times, 1U);
    EXPECT_DOUBLE_EQ(kept.share(cause.cut), row.share);
  }
}

TEST(KeptCauses, AreOrderedByWhatTheyCost) {
  const KeptCauses kept = causes_of(std::string(kBegin) +
                                    "G1 X1\nX2\nX3\nG91\nX1\nG90\nG1 X4\nX5\nX6\nG91\nX2\n"
                                    "G90\nG41 D1\nX60\n");
  ASSERT_GE(kept.causes.size(), 2U);
  EXPECT_EQ(kept.causes[0].reason, reason::kCutterCompensation);
  EXPECT_EQ(kept.causes[1].reason, reason::kIncremental);
  EXPECT_EQ(kept.causes[1].line, 7U);
  EXPECT_EQ(kept.causes[1].times, 2U);
  EXPECT_DOUBLE_EQ(kept.causes[1].cut.length_mm, 3);
}

TEST(KeptCauses, OfAProgramWithoutARunSaySo) {
  EXPECT_FALSE(causes_of("G21\nG0 X5\nM30\n").any_run);
  EXPECT_EQ(causes_of("G21\nG0 X5\nM30\n").all.moves, 0U);
  const KeptCauses incremental = causes_of("G21 G91\nG1 X1 F100\nX1\nX1\nX1\n");
  EXPECT_FALSE(incremental.any_run);
  EXPECT_EQ(incremental.causes[0].line, 1U);
}

TEST(KeptCauses, OfPartsAreThoseOfTheWhole) {
  const std::string text = std::string(kBegin) +
                           "G1 X1\nX2\nX3\nG41 D1\nX5\nX6\nX7\nG40\nX8\nX9\nG41 D1\nX12\nX13\n"
                           "G55\nX14\nX15\n";
  const KeptCauses whole = causes_of(text);
  for (std::size_t blocks = 7; blocks < 18; ++blocks) {
    SCOPED_TRACE(blocks);
    const KeptCauses parts = causes_of(text, blocks);
    EXPECT_EQ(parts.all.moves, whole.all.moves);
    for (const KeptCause& cause : whole.causes) {
      if (cause.reason == reason::kTooShort) continue;  // a run that is cut may be too short
      const auto same = std::ranges::find(parts.causes, cause.reason, &KeptCause::reason);
      ASSERT_NE(same, parts.causes.end()) << cause.reason;
      EXPECT_EQ(same->line, cause.line);
      EXPECT_EQ(same->text, cause.text);
      EXPECT_EQ(same->first_line, cause.first_line);
      EXPECT_EQ(same->times, cause.times);
      EXPECT_EQ(same->cut.moves, cause.cut.moves);
    }
  }
}

}  // namespace
}  // namespace batten::postproc
