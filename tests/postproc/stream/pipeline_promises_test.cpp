// Every promise of `smooth_program`, on many programs with all sorts of things strewn in.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "postproc/stream/pipeline.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

struct ManyCase {
  unsigned seed = 0;
  std::string_view target;
  Form form = Form::kAuto;
  Prefer prefer = Prefer::kTime;
  double tolerance_mm = 0.01;
};

void PrintTo(const ManyCase& test, std::ostream* out) {
  *out << "seed " << test.seed << " for " << test.target << ", " << name_of(test.form) << ", "
       << name_of(test.prefer) << ", " << test.tolerance_mm << " mm";
}

// Runs with plunges, feeds, comments, coolant and rapids strewn in.
std::string strewn_program(unsigned seed) {
  std::mt19937 random(seed);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  Wave wave;
  wave.seed = seed;
  wave.lines = 60 + below(120);
  wave.step = 0.05 + 0.05 * below(10);
  wave.height = 0.5 * below(8);
  wave.length = 4 + below(30);
  wave.noise = 0.002 * below(3);
  std::vector<std::string> lines = wave_lines(wave);
  for (std::string& line : lines) {
    const int what = below(60);
    if (what == 0) line += " (here)";
    if (what == 1) line += fmt::format(" F{}", 500 + 100 * below(20));
    if (what == 2) line += "\nZ-1.5";
    if (what == 3) line += "\nM8";
    if (what == 4) line += "\n";
    if (what == 5) line += "\nG0 Z5\nG1 Z-1 F300\nF1200";
  }
  return head("G21") + joined(lines, "\n") + tail();
}

SmoothOptions options_of(const ManyCase& test) {
  SmoothOptions options = options_for(test.target);
  options.output = test.form;
  options.prefer = test.prefer;
  options.tolerance_mm = test.tolerance_mm;
  return options;
}

class ManyPrograms : public testing::TestWithParam<ManyCase> {};

TEST_P(ManyPrograms, AreProvedOtherwiseCopiedAndTheSameForTwoThreadsAndASecondPass) {
  const std::string text = strewn_program(GetParam().seed);
  SmoothOptions options = options_of(GetParam());
  const SmoothResult result = smoothed(text, options);
  EXPECT_TRUE(result.understood);
  EXPECT_TRUE(result.proved);
  EXPECT_LE(result.deviation_mm, options.tolerance_mm);
  const Verification found = verdict(text, result.text, options.tolerance_mm);
  EXPECT_TRUE(found.proved()) << found.violations.front().message;
  expect_rest_copied(text, result);
  for (const RunReport& run : result.runs) {
    EXPECT_EQ(run.reason.empty(), run.status == RunStatus::kRewritten);
    EXPECT_TRUE(run.proved);
    EXPECT_LE(run.deviation_mm, options.tolerance_mm);
    const double costs = options.output == Form::kAuto ? 1.006 : 1.16;  // a form asked for by name
    EXPECT_LE(run.time_after_s, costs * run.time_before_s) << "line " << run.first_line;
  }
  const SmoothResult twice = smoothed(result.text, options);
  EXPECT_EQ(twice.text, result.text) << "a second pass";
  EXPECT_TRUE(twice.proved);
  options.threads = 2;
  EXPECT_EQ(smoothed(text, options).text, result.text) << "two threads";
}

std::vector<ManyCase> many_cases() {
  return {
      {1, "linuxcnc"},
      {2, "linuxcnc", Form::kArcs},
      {3, "linuxcnc", Form::kLines},
      {4, "linuxcnc", Form::kAuto, Prefer::kSize},
      {5, "linuxcnc", Form::kAuto, Prefer::kAccuracy},
      {6, "linuxcnc", Form::kAuto, Prefer::kTime, 0.1},
      {7, "linuxcnc", Form::kAuto, Prefer::kTime, 0.002},
      {8, "grbl"},
      {9, "grbl", Form::kArcs, Prefer::kSize},
      {10, "grbl", Form::kLines, Prefer::kTime, 0.05},
  };
}

INSTANTIATE_TEST_SUITE_P(Pipeline, ManyPrograms, testing::ValuesIn(many_cases()));

// The promises above would hold of a Batten that does nothing.
TEST(Pipeline, RewritesMostOfTheManyPrograms) {
  std::size_t rewritten = 0;
  for (const ManyCase& test : many_cases()) {
    const SmoothResult result = smoothed(strewn_program(test.seed), options_of(test));
    rewritten += rewritten_runs(result) > 0 ? 1 : 0;
  }
  EXPECT_GE(rewritten, 7u) << "of " << many_cases().size();
}

}  // namespace
}  // namespace batten::postproc
