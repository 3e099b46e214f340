#include "postproc/stream/run_sample.h"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace batten::postproc {
namespace {

double represented(const std::vector<std::size_t>& moves) {
  double sum = 0;
  for (const SampledRun& run : sample_of(moves)) {
    sum += run.stands_for * static_cast<double>(moves[run.run]);
  }
  return sum;
}

double all_of(const std::vector<std::size_t>& moves) {
  return static_cast<double>(std::accumulate(moves.begin(), moves.end(), std::size_t{0}));
}

TEST(RunSample, IsAllOfFew) {
  EXPECT_TRUE(sample_of({}).empty());
  const std::vector<std::size_t> moves(kRunSample.least, 7);
  const std::vector<SampledRun> sample = sample_of(moves);
  ASSERT_EQ(sample.size(), moves.size());
  for (std::size_t i = 0; i < sample.size(); ++i) {
    EXPECT_EQ(sample[i].run, i);
    EXPECT_EQ(sample[i].stands_for, 1);
  }
}

TEST(RunSample, OfLikeRunsIsSpreadEvenly) {
  const std::vector<std::size_t> moves(1024, 50);
  const std::vector<SampledRun> sample = sample_of(moves);
  const std::size_t step = 16;
  ASSERT_EQ(sample.size(), 64u);
  for (std::size_t i = 0; i < sample.size(); ++i) {
    EXPECT_EQ(sample[i].run / step, i);
    EXPECT_NEAR(sample[i].stands_for, static_cast<double>(step), 1e-9);
  }
}

TEST(RunSample, StandsForAllMoves) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<std::size_t> moves(1 + random() % 400);
    for (std::size_t& run : moves) run = 3 + random() % (random() % 9 == 0 ? 2000 : 40);
    EXPECT_NEAR(represented(moves), all_of(moves), 1e-6 * all_of(moves));
    const std::vector<SampledRun> sample = sample_of(moves);
    EXPECT_LE(sample.size(), std::max(kRunSample.least, moves.size() / kRunSample.one_of) + 1);
    for (std::size_t i = 1; i < sample.size(); ++i) EXPECT_LT(sample[i - 1].run, sample[i].run);
  }
}

TEST(RunSample, HasEachLongRunForItself) {
  std::vector<std::size_t> moves(200, 10);
  for (const std::size_t at : {0u, 77u, 199u}) moves[at] = 5000;
  std::size_t long_runs = 0;
  for (const SampledRun& run : sample_of(moves)) {
    if (moves[run.run] != 5000) continue;
    ++long_runs;
    EXPECT_EQ(run.stands_for, 1);
  }
  EXPECT_EQ(long_runs, 3u);
}

}  // namespace
}  // namespace batten::postproc
