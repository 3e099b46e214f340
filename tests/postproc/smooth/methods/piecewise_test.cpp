// Runs whose parts differ are chosen piece by piece.
#include <gtest/gtest.h>

#include <cmath>

#include "gcode/state/reason.h"
#include "postproc/smooth/run_smoother.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// Half of the vertices finely on a wave, half of them coarsely on steps far greater than the
// tolerance, which nothing can be gained from at a feed that the machine holds.
std::string half_coarse_program(int lines) {
  std::vector<std::string> all = wave_lines({.lines = lines, .step = 0.05, .feed = 300});
  const double x = 0.05 * lines;
  for (int i = 1; i <= lines; ++i) {
    const double y = 0.3 * std::sin(1.7 * i) + 0.3 * std::cos(2.9 * i);
    all.push_back(fmt::format("X{:.3f} Y{:.3f}", x + 1.0 * i, y));
  }
  return head("G21") + joined(all, "\n") + tail();
}

TEST(Piecewise, RewritesThePartThatGainsAndKeepsTheOtherAndSaysWhy) {
  const std::string text = half_coarse_program(700);
  SmoothOptions options = options_for("linuxcnc");
  options.output = Form::kLines;  // of the whole they would be more
  const SmoothResult result = smoothed(text, options);
  ASSERT_TRUE(result.proved);
  EXPECT_GE(rewritten_runs(result), 1U);
  EXPECT_LT(result.blocks_out, result.blocks_in * 3 / 4);
  expect_rest_copied(text, result);
  const std::vector<std::string> lines = lines_of(text);
  EXPECT_NE(result.text.find(lines[1200]), std::string::npos) << "a coarse line";
  EXPECT_LE(result.runs_after_s, 1.005 * result.runs_before_s);
  std::uint32_t next = 5;  // the head has four lines
  for (const RunReport& run : result.runs) {
    if (run.last_line < next) continue;
    EXPECT_EQ(run.first_line, next);
    EXPECT_EQ(run.status == RunStatus::kKept, !run.reason.empty());
    next = run.last_line + 1;
  }
  EXPECT_EQ(next, 5U + 1400U);
}

TEST(Piecewise, GivesTheSameBytesForAnyNumberOfThreads) {
  const std::string text = half_coarse_program(800);
  SmoothOptions options = options_for("linuxcnc");
  const SmoothResult one = smoothed(text, options);
  options.threads = 2;
  EXPECT_EQ(smoothed(text, options).text, one.text);
}

// --- settle ----------------------------------------------------------------------------------

// A straight run of ten pieces of ten millimetres at 10 mm/s. Every second one has a candidate
// that goes over its way `there_and_back` times.
class Settle : public testing::Test {
 protected:
  void make(int there_and_back) {
    cut_.path = gcode::PathMode::kBlending;
    cut_.pieces = 10;
    cut_.run.feeds = {{0, 600}};
    for (int i = 0; i <= 10; ++i) cut_.run.points.emplace_back(10 * i, 0, 0);
    const gcode::ModalState& state = read_.meaning.states.front();
    for (std::size_t i = 0; i < 10; ++i) {
      RunState work{i, {read_.program, state, state, "\n", 1, 10}};
      work.first = i;
      work.last = i + 1;
      work.smoothed.facts.scale.original.times = {1, 1, 1};
      if (i % 2 == 1) {
        Candidate candidate;
        const geometry::Point3 from = cut_.run.points[i];
        const geometry::Point3 to = cut_.run.points[i + 1];
        std::vector<TimedPiece> moves = {{geometry::Line{from, to}, 600}};
        for (int k = 0; k < there_and_back; ++k) {
          moves.push_back({geometry::Line{to, from}, 600});
          moves.push_back({geometry::Line{from, to}, 600});
        }
        candidate.moves = PackedMoves(moves);
        candidate.figures.times = {1, 1, 1};  // it looked as good as that, alone
        work.smoothed.candidates.push_back(candidate);
        work.selection.order = {0};
      }
      works_.push_back(std::move(work));
    }
    revert_costly_pieces(cut_, works_, options_for("linuxcnc"));
  }

  [[nodiscard]] std::size_t rewritten() const {
    std::size_t count = 0;
    for (const RunState& work : works_) count += work.chosen() != nullptr ? 1 : 0;
    return count;
  }

  ReadText read_{"G21\n"};
  CutRun cut_;
  std::vector<RunState> works_;
};

TEST_F(Settle, KeepsPiecesThatDoNotSlowTheRunDown) {
  make(0);
  EXPECT_EQ(rewritten(), 5U);
  EXPECT_NEAR(cut_.after.programmed, cut_.before.programmed, 1e-3 * cut_.before.programmed);
}

TEST_F(Settle, GivesPiecesBackUntilTheRunIsNotSlower) {
  make(1);
  EXPECT_EQ(rewritten(), 0U);
  EXPECT_EQ(cut_.after.programmed, cut_.before.programmed);
  EXPECT_EQ(works_[1].reject_reason, gcode::reason::kSlower);
}

}  // namespace
}  // namespace batten::postproc
