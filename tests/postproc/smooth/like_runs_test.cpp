// Of many runs that are alike some are smoothed in full; the others are made in fewer forms, and
// come out as well.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "gcode/interpreter/interpreter.h"
#include "gcode/reading/parser.h"
#include "postproc/smooth/part_runs.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr int kWaves = 48;

// Waves of growing height with chords of 0.3 mm, one beside the other: none repeats another.
ProgramPart waves_side_by_side() {
  std::string text = "G21 G90 G17 G64 P0.01 Q0.01\nG0 X0 Y0 Z5\n";
  for (int wave = 0; wave < kWaves; ++wave) {
    const double height = 2 + 0.05 * wave;
    text += fmt::format("G0 X0 Y{:.4f}\nG1 Z-1 F300\nG4 P0.1\n", 10.0 * wave);
    for (int i = 1; i <= 120; ++i) {
      text += fmt::format("{}X{:.4f} Y{:.4f}{}\n", i == 1 ? "G1 " : "", 0.3 * i,
                          10 * wave + height * std::sin(0.1 * i), i == 1 ? " F2000" : "");
    }
    text += "G0 Z5\n";
  }
  gcode::Diagnostics found;
  gcode::Program program = gcode::parse(gcode::SourceText("waves.nc", text + "M2\n"), found);
  gcode::Interpretation meaning = gcode::interpret(program, {}, found);
  return {std::move(program), std::move(meaning), {}};
}

struct LikeTotals {
  std::size_t runs = 0;
  std::size_t tried = 0;  // forms
  double cost = 0;
};

void add_run(const SmoothedRun& run, const SmoothOptions& options, LikeTotals& totals) {
  ++totals.runs;
  totals.tried += run.tried.size();
  totals.cost += cost_to_beat(run, options);
}

PartRuns smoothed_waves(const ProgramPart& part, const SmoothOptions& options,
                        RunMemos* memos = nullptr) {
  PartRuns runs = find_runs(part, options);
  EXPECT_TRUE(smooth_runs(
      part, options, [](double) { return true; }, runs, memos));
  return runs;
}

LikeTotals totals_of(const PartRuns& runs, const SmoothOptions& options) {
  LikeTotals totals;
  for (const RunState& work : runs.works) add_run(work.smoothed, options, totals);
  return totals;
}

// Each by itself.
LikeTotals totals_in_full(const PartRuns& runs, const SmoothOptions& options) {
  LikeTotals totals;
  for (const RunState& work : runs.works) {
    const Run& run = std::get<Run>(runs.sections[work.section].content);
    add_run(smooth_run(run, work.context, options), options, totals);
  }
  return totals;
}

class LikeRuns : public testing::TestWithParam<Prefer> {};

TEST_P(LikeRuns, AreMadeInFewerFormsAndComeOutAsWell) {
  SmoothOptions options = options_for("linuxcnc");
  options.prefer = GetParam();
  const ProgramPart part = waves_side_by_side();
  const PartRuns runs = smoothed_waves(part, options);
  const LikeTotals now = totals_of(runs, options);
  const LikeTotals full = totals_in_full(runs, options);
  ASSERT_EQ(now.runs, kWaves);
  fmt::print("forms {} of {}, cost {:.5f} of {:.5f}\n", now.tried, full.tried, now.cost, full.cost);
  // For accuracy the bounds leave one form a run.
  const double most = GetParam() == Prefer::kAccuracy ? 1 : 0.5;
  EXPECT_LE(static_cast<double>(now.tried), most * static_cast<double>(full.tried));
  EXPECT_LE(now.cost, 1.001 * full.cost);
}

TEST_P(LikeRuns, ComeOutTheSameForAnyThreads) {
  SmoothOptions options = options_for("linuxcnc");
  options.prefer = GetParam();
  const ProgramPart part = waves_side_by_side();
  options.threads = 1;
  const PartRuns one = smoothed_waves(part, options);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    const PartRuns more = smoothed_waves(part, options);
    ASSERT_EQ(more.works.size(), one.works.size());
    for (std::size_t i = 0; i < one.works.size(); ++i) {
      ASSERT_NE(one.works[i].chosen(), nullptr) << i;
      ASSERT_NE(more.works[i].chosen(), nullptr) << i;
      EXPECT_EQ(more.works[i].chosen()->text.text, one.works[i].chosen()->text.text) << i;
      EXPECT_EQ(more.works[i].outlook.others.sum(), one.works[i].outlook.others.sum()) << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EachPreference, LikeRuns,
                         testing::Values(Prefer::kTime, Prefer::kAccuracy, Prefer::kSize),
                         [](const auto& each) { return std::string(name_of(each.param)); });

// What is known of a form is known by its key: no run has two forms of one.
TEST_P(LikeRuns, HaveOneFormForEachKey) {
  for (const char* target : {"linuxcnc", "grbl", "siemens"}) {
    SmoothOptions options = options_for(target);
    options.prefer = GetParam();
    const ProgramPart part = waves_side_by_side();
    for (const RunState& work : smoothed_waves(part, options).works) {
      std::vector<FormKey> keys;
      for (const TriedForm& form : work.smoothed.tried) keys.push_back(form.key);
      std::ranges::sort(keys);
      EXPECT_TRUE(std::ranges::adjacent_find(keys) == keys.end()) << target;
    }
  }
}

// Of methods that are asked for by name.
TEST(AllLikeRuns, AreMadeInFullWhereAMethodIsAskedFor) {
  SmoothOptions options = options_for("linuxcnc");
  const ProgramPart part = waves_side_by_side();
  for (const auto& [method, shares] :
       {std::pair(Method::kBest, false), std::pair(Method::kFair, true)}) {
    options.method = method;
    options.share_work = shares;
    const PartRuns runs = smoothed_waves(part, options);
    EXPECT_EQ(totals_of(runs, options).tried, totals_in_full(runs, options).tried);
  }
}

TEST(AllLikeRuns, AreExploredInTheFormsInWhichTheyAreSmoothed) {
  const SmoothOptions options = options_for("linuxcnc");
  const ProgramPart part = waves_side_by_side();
  RunMemos memos;
  const LikeTotals explored = totals_of(smoothed_waves(part, options, &memos), options);
  const LikeTotals smoothed = totals_of(smoothed_waves(part, options), options);
  EXPECT_EQ(explored.tried, smoothed.tried);
  EXPECT_EQ(explored.cost, smoothed.cost);
}

}  // namespace
}  // namespace batten::postproc
