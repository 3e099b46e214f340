// Where long runs are cut, and that their pieces are the run.
#include "postproc/runs/run_cutting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "postproc/runs/run_grouping.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using geometry::Point3;

// Rows along X, 0.1 mm a step, joined by one step of 1 mm in Y at their ends.
std::vector<Point3> raster(int rows, int steps) {
  std::vector<Point3> points;
  for (int row = 0; row < rows; ++row) {
    for (int i = 0; i <= steps; ++i) {
      const double x = 0.1 * (row % 2 == 0 ? i : steps - i);
      points.emplace_back(x, row, 0.2 * std::sin(x));
    }
  }
  return points;
}

postproc::Run run_through(std::vector<Point3> points) {
  postproc::Run run;
  run.points = std::move(points);
  return run;
}

TEST(CutPlaces, LeavesShortRunsWhole) {
  EXPECT_TRUE(cut_places(run_through(raster(1, 300)), {.shortest = 60, .longest = 400}).empty());
}

TEST(CutPlaces, CutsRasterRowsAtTheirEnds) {
  constexpr std::size_t kSteps = 149;  // a row and its step to the next: 150 vertices
  const std::vector<Point3> points = raster(12, kSteps);
  const std::vector<std::size_t> places =
      cut_places(run_through(points), {.shortest = 60, .longest = 400});
  ASSERT_FALSE(places.empty());
  for (const std::size_t place : places) {
    const std::size_t in_row = place % (kSteps + 1);
    EXPECT_TRUE(in_row == 0 || in_row == kSteps) << "vertex " << place;
  }
}

TEST(CutPlaces, KeepsTheSizesThatWereAskedFor) {
  std::vector<Point3> wave;
  for (int i = 0; i <= 5000; ++i) wave.emplace_back(0.1 * i, std::sin(0.05 * i), 0);
  constexpr CuttingOptions kOptions{.shortest = 60, .longest = 400};
  std::vector<std::size_t> ends = cut_places(run_through(wave), kOptions);
  ends.push_back(wave.size() - 1);
  std::size_t from = 0;
  for (const std::size_t end : ends) {
    EXPECT_GE(end - from, kOptions.shortest);
    EXPECT_LE(end - from, kOptions.longest);
    from = end;
  }
}

// A reversal costs nothing, whatever else there is.
TEST(CutPlaces, PrefersAReversalToACorner) {
  std::vector<Point3> points;
  for (int i = 0; i <= 200; ++i) points.emplace_back(0.1 * i, 0, 0);
  for (int i = 1; i <= 150; ++i) points.emplace_back(20 - 0.1 * i, 0, 0);  // turns by 180 degrees
  for (int i = 1; i <= 150; ++i) points.emplace_back(5, 0.1 * i, 0);       // by 90 degrees
  EXPECT_EQ(cut_places(run_through(points), {.shortest = 60, .longest = 400}),
            std::vector<std::size_t>{200});
}

double feed_at(const postproc::Run& run, std::size_t motion) {
  double feed = 0;
  for (const FeedFrom& from : run.feeds) {
    if (from.vertex <= motion) feed = from.feed;
  }
  return feed;
}

const postproc::Run& run_in(const Section& section) {
  return std::get<postproc::Run>(section.content);
}

// A wave whose feed changes, with comments, after some lines that say nothing: blocks, vertices,
// feeds, comments and states of the pieces are those of the run.
TEST(CutRun, GivesPiecesThatAreTheRun) {
  std::vector<std::string> lines = wave_lines({.lines = 300});
  for (std::size_t i = 0; i < lines.size(); i += 7) lines[i] += " (here)";
  for (std::size_t i = 25; i < lines.size(); i += 40) lines[i] += fmt::format(" F{}", 500 + i);
  const ReadText read(head("G21") + joined(lines, "\n") + tail());
  Section whole;
  for (const Section& section : group_runs(read.program, read.meaning, {})) {
    if (std::holds_alternative<postproc::Run>(section.content)) whole = section;
  }
  const auto pieces = cut_run(whole, read.meaning, {.shortest = 20, .longest = 60});
  ASSERT_GT(pieces.size(), 4U);
  std::uint32_t block = whole.first_block;
  std::size_t vertex = 0;
  std::size_t comment = 0;
  for (const RunPiece& piece : pieces) {
    const postproc::Run& run = run_in(piece.section);
    EXPECT_EQ(piece.section.first_block, block);
    EXPECT_EQ(run.state, read.meaning.blocks[block - 1].state_after);
    EXPECT_EQ(piece.first, vertex);
    ASSERT_EQ(run.points.size(), piece.last - piece.first + 1);
    ASSERT_FALSE(run.feeds.empty());
    EXPECT_EQ(run.feeds.front().vertex, 0U);
    for (std::size_t i = 0; i < run.points.size(); ++i) {
      EXPECT_EQ(run.points[i], run_in(whole).points[vertex + i]);
      if (i + 1 == run.points.size()) continue;
      EXPECT_EQ(feed_at(run, i), feed_at(run_in(whole), vertex + i)) << "motion " << vertex + i;
    }
    for (const CommentAt& each : run.comments) {
      ASSERT_LT(comment, run_in(whole).comments.size());
      EXPECT_EQ(vertex + each.vertex, run_in(whole).comments[comment].vertex);
      EXPECT_EQ(each.text.begin, run_in(whole).comments[comment++].text.begin);
    }
    block = piece.section.last_block + 1;
    vertex = piece.last;
  }
  EXPECT_EQ(block, whole.last_block + 1);
  EXPECT_EQ(vertex, run_in(whole).points.size() - 1);
  EXPECT_EQ(comment, run_in(whole).comments.size());
}

// What stands between two motions would have no place in either piece.
TEST(CutRun, DoesNotCutWhereOtherBlocksStand) {
  std::string text = head("G21");
  for (const std::string& line : wave_lines({.lines = 300})) text += line + "\n(note)\n";
  const ReadText read(text + tail());
  for (const Section& section : group_runs(read.program, read.meaning, {})) {
    if (!std::holds_alternative<postproc::Run>(section.content)) continue;
    EXPECT_EQ(cut_run(section, read.meaning, {.shortest = 20, .longest = 60}).size(), 1U);
  }
}

}  // namespace
}  // namespace batten::postproc
