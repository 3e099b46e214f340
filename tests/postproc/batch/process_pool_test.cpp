// A job that goes wrong ends alone.

#include "postproc/batch/process_pool.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <map>
#include <stdexcept>

namespace batten::postproc {
namespace {

constexpr std::chrono::seconds kLong{20};

std::map<std::size_t, JobEnd> run_all(ProcessPool& pool, std::size_t jobs) {
  std::map<std::size_t, JobEnd> ends;
  std::size_t next = 0;
  while (next < jobs || !pool.is_idle()) {
    while (next < jobs && pool.has_room()) {
      EXPECT_TRUE(pool.start(next));
      ++next;
    }
    if (const auto end = pool.wait(kLong)) ends[end->job] = *end;
  }
  return ends;
}

TEST(ProcessPool, GivesEveryAnswerWhateverItsLength) {
  ProcessPool pool(3, [](std::size_t job) { return std::string(job * 30'000, 'x'); });
  const auto ends = run_all(pool, 8);
  ASSERT_EQ(ends.size(), 8u);
  for (const auto& [job, end] : ends) {
    EXPECT_EQ(end.answer, std::string(job * 30'000, 'x')) << job;
    EXPECT_EQ(end.trouble, "") << job;
  }
}

TEST(ProcessPool, TellsHowAJobEndedAndGoesOn) {
  ProcessPool pool(2, [](std::size_t job) -> std::string {
    if (job == 1) ::raise(SIGKILL);
    if (job == 2) throw std::runtime_error("no");
    if (job == 3) ::_exit(9);
    return "fine";
  });
  const auto ends = run_all(pool, 5);
  EXPECT_EQ(ends.at(0).answer, "fine");
  EXPECT_EQ(ends.at(1).trouble, "ended by signal 9");
  EXPECT_EQ(ends.at(2).trouble, "ended with code 70");
  EXPECT_EQ(ends.at(3).trouble, "ended with code 9");
  EXPECT_EQ(ends.at(4).answer, "fine");
}

TEST(ProcessPool, RunsAsManyAtATimeAsItMay) {
  ProcessPool pool(2, [](std::size_t) {
    ::pause();
    return std::string();
  });
  EXPECT_TRUE(pool.start(0));
  EXPECT_TRUE(pool.has_room());
  EXPECT_TRUE(pool.start(1));
  EXPECT_FALSE(pool.has_room());
  EXPECT_FALSE(pool.wait(std::chrono::milliseconds(20)).has_value());
  pool.stop();
  EXPECT_EQ(pool.wait(kLong)->trouble, "ended by signal 15");
  EXPECT_TRUE(pool.has_room());
  EXPECT_EQ(pool.wait(kLong)->trouble, "ended by signal 15");
  EXPECT_TRUE(pool.is_idle());
}

}  // namespace
}  // namespace batten::postproc
