#include "postproc/smooth/selection/form_record.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace batten::postproc {
namespace {

using Outcome = FormRecord::Outcome;

constexpr FormKey kNearArcs{CurveRole::kFirst, Form::kArcs, Along::kCurve, 0};
constexpr FormKey kFarArcs{CurveRole::kFirst, Form::kArcs, Along::kCurve, 1};
constexpr FormKey kChords{CurveRole::kFirst, Form::kLines, Along::kCurve, 0};
constexpr FormKey kRounded{CurveRole::kRounding, Form::kLines, Along::kCurve, 0};

constexpr double kSizeWeight = 0.01;
constexpr double kMargin = kRecord.margin * kSizeWeight;

Outcome written(const FormKey& key, double cost, double blocks, double expected = 0) {
  return {{key, expected}, true, cost, blocks};
}

Outcome in_vain(const FormKey& key) { return {{key}}; }

FormRecord learned(const std::vector<std::vector<Outcome>>& runs) {
  FormRecord record;
  for (const auto& outcomes : runs) record.add(100, outcomes);
  record.learn(kSizeWeight);
  return record;
}

TEST(RunsInFull, AreSpreadOverAllAndAllOfFew) {
  for (const std::size_t runs : {0UL, 1UL, 6UL, 11UL, 12UL, 40UL, 96UL, 97UL, 1000UL}) {
    const std::vector<std::size_t> full = runs_in_full(runs);
    const std::size_t expected = runs < 12 ? runs : std::max<std::size_t>(6, (runs + 15) / 16);
    ASSERT_EQ(full.size(), expected) << runs;
    for (std::size_t i = 0; i < full.size(); ++i) {
      EXPECT_LT(full[i], runs);
      // In the middle of its share of the runs.
      const double middle = (static_cast<double>(i) + 0.5) * static_cast<double>(runs) /
                            static_cast<double>(full.size());
      EXPECT_LE(std::abs(static_cast<double>(full[i]) - middle), 1) << runs;
      EXPECT_TRUE(i == 0 || full[i - 1] < full[i]);
    }
  }
}

TEST(FormRecord, SaysNothingOfFormsThatItDoesNotKnow) {
  const FormRecord record = learned({{written(kChords, 0.9, 0.5)}});
  EXPECT_FALSE(record.predicted({kNearArcs}, kChords, 0.9));
  EXPECT_FALSE(record.predicted(CurveRole::kRounding, kChords, 0.9));
  EXPECT_TRUE(record.predicted({kChords}, std::nullopt, 1));
}

// Runs differ, and their forms with them: what counts is how much better one was beside another.
TEST(FormRecord, PredictsByWhatAFormHadMoreThanTheBestSoFarOnTheSameRuns) {
  const FormRecord record = learned({{written(kChords, 0.90, 0.5), written(kFarArcs, 0.92, 0.2)},
                                     {written(kChords, 0.50, 0.5), written(kFarArcs, 0.54, 0.2)},
                                     {written(kChords, 0.10, 0.5)}});
  EXPECT_NEAR(*record.predicted({kFarArcs}, kChords, 0.3), 0.33 - kMargin, 1e-12);
  EXPECT_NEAR(*record.predicted({kChords}, kFarArcs, 0.3), 0.27 - kMargin, 1e-12);
  // Beside the blocks as they are, its mean.
  EXPECT_NEAR(*record.predicted({kChords}, std::nullopt, 1), 0.5 - kMargin, 1e-12);
  EXPECT_NEAR(*record.predicted(CurveRole::kFirst, kChords, 0.3), 0.3 - kMargin, 1e-12);
}

TEST(FormRecord, ComparesByTwoRunsAtLeast) {
  const FormRecord record = learned({{written(kChords, 0.90, 0.5), written(kFarArcs, 0.92, 0.2)},
                                     {written(kFarArcs, 0.52, 0.2)}});
  EXPECT_NEAR(*record.predicted({kFarArcs}, kChords, 0.3), 0.72 - kMargin, 1e-12);
}

TEST(FormRecord, CountsRunsByTheirBlocks) {
  FormRecord record;
  record.add(300, {written(kChords, 0.8, 0.5)});
  record.add(100, {written(kChords, 0.4, 0.5)});
  record.learn(kSizeWeight);
  EXPECT_NEAR(*record.predicted({kChords}, std::nullopt, 1), 0.7 - kMargin, 1e-12);
}

TEST(FormRecord, HasNoHopeForAFormThatNeverMayBeWrittenOnThreeRuns) {
  const std::vector<Outcome> both = {written(kChords, 0.9, 0.5), in_vain(kNearArcs)};
  EXPECT_FALSE(learned({both, both}).predicted({kNearArcs}, kChords, 0.9));
  EXPECT_TRUE(std::isinf(*learned({both, both, both}).predicted({kNearArcs}, kChords, 0.9)));
  const std::vector<Outcome> once = {written(kChords, 0.9, 0.5), written(kNearArcs, 0.8, 0.5)};
  EXPECT_NEAR(*learned({both, both, both, once}).predicted({kNearArcs}, std::nullopt, 1),
              0.8 - kMargin, 1e-12);
}

// All of its forms are unknown, or one of them is.
TEST(FormRecord, SaysNothingOfACurveWhileOneOfItsFormsIsNotKnown) {
  const std::vector<Outcome> outcomes = {in_vain(kRounded), written(kChords, 0.9, 0.5)};
  EXPECT_FALSE(learned({outcomes}).predicted(CurveRole::kRounding, kChords, 0.9));
  const FormRecord record = learned({outcomes, outcomes, outcomes});
  EXPECT_TRUE(std::isinf(*record.predicted(CurveRole::kRounding, kChords, 0.9)));
}

// Of twice as many blocks as were expected, always: a run in which more are expected costs more.
TEST(FormRecord, PricesBlocksAsTheyWereExpected) {
  const FormRecord record =
      learned({{written(kFarArcs, 0.9, 0.2, 0.1)}, {written(kFarArcs, 0.9, 0.2, 0.1)}});
  EXPECT_NEAR(*record.predicted({kFarArcs, 0.1}, std::nullopt, 1), 0.9 - kMargin, 1e-12);
  EXPECT_NEAR(*record.predicted({kFarArcs, 0.3}, std::nullopt, 1),
              0.9 + kSizeWeight * 0.4 - kMargin, 1e-12);
  EXPECT_NEAR(*record.predicted({kFarArcs}, std::nullopt, 1), 0.9 - kMargin, 1e-12);
}

}  // namespace
}  // namespace batten::postproc
