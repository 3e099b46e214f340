// Runs that were chosen one by one, judged together.
#include "postproc/smooth/growth.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "gcode/state/reason.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

Figures figures(double seconds, double blocks, double bytes, double distance) {
  return {{seconds, seconds, seconds}, blocks, bytes, distance, 0.1};
}

// Runs of 100 mm in 100 blocks of 1000 bytes, which take 10 s and are 0.004 mm off.
class Growth : public testing::Test {
 protected:
  // Candidates in the order of the choice; none: the run is kept.
  void add(const std::vector<Figures>& candidates) {
    const gcode::ModalState& state = read_.meaning.states.front();
    RunState work{works_.size(), {read_.program, state, state, "\n", 100, 1000}};
    work.smoothed.facts.scale.original = figures(10, 100, 1000, 0.004);
    work.smoothed.facts.scale.alone = 10;
    work.smoothed.facts.length = 100;
    for (const Figures& each : candidates) {
      work.selection.order.push_back(work.smoothed.candidates.size());
      work.smoothed.candidates.emplace_back().figures = each;
    }
    works_.push_back(std::move(work));
  }

  // Indices of the chosen candidates, -1 where the run is kept.
  std::vector<int> settled(Prefer prefer = Prefer::kTime, std::string_view target = "linuxcnc") {
    SmoothOptions options = options_for(target);
    options.prefer = prefer;
    revert_growth(works_, cut_runs_, options);
    std::vector<int> chosen;
    for (const RunState& work : works_) {
      const bool any = work.chosen() != nullptr;
      chosen.push_back(any ? static_cast<int>(work.selection.order[work.tried]) : -1);
    }
    return chosen;
  }

  ReadText read_{"G21\n"};
  std::vector<RunState> works_;
  std::vector<CutRun> cut_runs_;
};

using Chosen = std::vector<int>;

TEST_F(Growth, StaysWhereTheWholeIsAPercentFaster) {
  add({figures(9, 140, 1400, 0.004)});
  for (int i = 0; i < 8; ++i) add({});
  EXPECT_EQ(settled(), (Chosen{0, -1, -1, -1, -1, -1, -1, -1, -1}));
}

TEST_F(Growth, GoesWhereTheWholeIsNot) {
  add({figures(9, 140, 1400, 0.004)});
  for (int i = 0; i < 10; ++i) add({});
  EXPECT_EQ(settled(), Chosen(11, -1));
  EXPECT_EQ(works_[0].reject_reason, gcode::reason::kLarger);
}

TEST_F(Growth, IsPaidByWhatIsSmallerElsewhere) {
  add({figures(9.95, 120, 1000, 0.004)});  // the least seconds for a block
  add({figures(9.8, 120, 1000, 0.004)});
  add({figures(10, 75, 1000, 0.004)});
  EXPECT_EQ(settled(), (Chosen{-1, 0, 0}));
}

TEST_F(Growth, ChangesToACandidateThatDoesNotGrow) {
  add({figures(9.95, 120, 1000, 0.004), figures(9.96, 110, 1000, 0.004),
       figures(9.99, 100, 1000, 0.002)});
  add({});
  EXPECT_EQ(settled(), (Chosen{2, -1}));
}

TEST_F(Growth, OfBytesIsPaidByHalfTheDistance) {
  add({figures(10, 100, 1100, 0.001)});
  EXPECT_EQ(settled(), Chosen{0});
  add({});
  EXPECT_EQ(settled(), (Chosen{-1, -1}));
}

TEST_F(Growth, OfTheDistanceGoesAsThatOfBlocksDoes) {
  add({figures(9.75, 50, 500, 0.006)});
  EXPECT_EQ(settled(), Chosen{0});
  add({});
  EXPECT_EQ(settled(), (Chosen{0, -1}));
  add({});
  EXPECT_EQ(settled(), (Chosen{-1, -1, -1}));
  EXPECT_EQ(works_[0].reject_reason, gcode::reason::kFarther);
}

// Runs of windows before it pay, too, or are paid for; they stay as they are.
TEST_F(Growth, OfAWindowIsMeasuredWithTheRunsBeforeIt) {
  const PartSums as_it_was{1000, {100, 1000, 10000, 0.016}, {}};
  PartSums smaller = as_it_was;
  smaller.change.blocks = -30;
  PartSums larger = as_it_was;
  larger.change.blocks = 30;
  larger.change.time = -1.01;  // a percent of its own time, and less of both
  for (const auto& [beside, chosen] :
       {std::pair{as_it_was, -1}, std::pair{smaller, 0}, std::pair{larger, -1}}) {
    works_.clear();
    add({figures(9.95, 120, 1000, 0.004)});
    add({});
    revert_growth(works_, cut_runs_, options_for("linuxcnc"), beside);
    EXPECT_EQ(works_[0].chosen() != nullptr, chosen == 0) << beside.change.blocks;
  }
}

// Its comment is 35 bytes behind a block. Of 1000 bytes they are less than a run may grow.
TEST_F(Growth, OfAProgramByItsCommentAloneIsNotWorthIt) {
  add({figures(10, 100, 970, 0.004)});
  EXPECT_EQ(settled(), Chosen{-1});
  EXPECT_EQ(works_[0].reject_reason, gcode::reason::kNoGain);
}

// A block less than before makes up for a hundredth of bytes more: half of each counts.
TEST_F(Growth, ByTheCommentIsMeasuredInBlocksAndBytes) {
  for (const auto& [figures, chosen] :
       {std::pair{figures(10, 99, 980, 0.004), -1}, std::pair{figures(10, 99, 970, 0.004), 0},
        std::pair{figures(10, 100, 960, 0.004), 0}}) {
    works_.clear();
    add({figures});
    EXPECT_EQ(settled(), Chosen{chosen});
  }
}

TEST_F(Growth, OfNoCommentIsNone) {
  add({figures(10, 100, 970, 0.004)});
  EXPECT_EQ(settled(Prefer::kTime, "codesys"), Chosen{0});
}

TEST_F(Growth, ByTheCommentIsPaidByBlocksBytesTimeDistanceOrRoughness) {
  Figures smoother = figures(10, 100, 970, 0.004);
  smoother.roughness = 0.04;
  for (const Figures& paid :
       {figures(10, 98, 970, 0.004), figures(10, 100, 950, 0.004), figures(9.9, 100, 970, 0.004),
        figures(10, 100, 970, 0.002), smoother}) {
    works_.clear();
    add({paid});
    EXPECT_EQ(settled(), Chosen{0});
  }
}

TEST_F(Growth, OfAFormThatIsAskedForStays) {
  add({figures(10, 140, 1400, 0.006)});
  works_[0].smoothed.candidates[0].form = Form::kArcs;
  SmoothOptions options = options_for("linuxcnc");
  options.output = Form::kArcs;
  revert_growth(works_, cut_runs_, options);
  EXPECT_NE(works_[0].chosen(), nullptr);
}

}  // namespace
}  // namespace batten::postproc
