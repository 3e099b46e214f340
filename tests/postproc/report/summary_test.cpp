#include <gtest/gtest.h>

#include "postproc/report/summary_text.h"
#include "tests/support/report_words.h"

namespace batten::postproc {
namespace {

class Summary : public testing::Test {
 protected:
  [[nodiscard]] std::string text() const {
    return summary_text({.source = source_,
                         .options = options_,
                         .result = result_,
                         .output_file = "part.smooth.nc"});
  }
  [[nodiscard]] bool says(std::string_view words) const {
    return text().find(words) != std::string::npos;
  }

  gcode::SourceText source_{"part.nc", std::string(100, '\n')};
  SmoothOptions options_ = linuxcnc_options();
  SmoothResult result_ = five_runs();
};

TEST_F(Summary, NamesFilesAndTarget) {
  EXPECT_TRUE(says("part.nc -> part.smooth.nc, for linuxcnc\n")) << text();
}

// 200 -> 50 blocks are 75 % less, 100 -> 10 bytes 90 %.
TEST_F(Summary, TellsWhatBecameSmaller) {
  EXPECT_TRUE(says("200 -> 50  (-75 %)")) << text();
  EXPECT_TRUE(says("100 -> 10  (-90 %)")) << text();
}

TEST_F(Summary, CountsRunsAndExplainsTheKeptOnes) {
  EXPECT_TRUE(says("2 rewritten, 3 kept")) << text();
  EXPECT_TRUE(says("kept: 1 run, 10 blocks (exact-stop): ")) << text();
  EXPECT_TRUE(says("kept: 2 runs, 5 blocks (too-short): ")) << text();
  EXPECT_TRUE(says("--allow exact-stop lifts this rule")) << text();
  EXPECT_FALSE(says("--allow too-short")) << text();
}

TEST_F(Summary, TellsTimesOfTheMachineModel) {
  EXPECT_TRUE(says("4.00 s -> 2.00 s  (machine linuxcnc, 2.0 times as fast)")) << text();
  result_.time_before_s = 7300;
  result_.time_after_s = 6570;
  EXPECT_TRUE(says("2 h 01 min -> 1 h 49 min  (machine linuxcnc, -10.0 %)")) << text();
}

// One run by guo, 0.5 s before fair; one by fair, 0.1 s before guo. Kept runs do not count.
TEST_F(Summary, TellsWhichMethodsWonAndByHowMuch) {
  EXPECT_FALSE(says("methods")) << "one method alone wins nothing";
  result_.runs[0].method = "guo";
  result_.runs[0].time_after_s = 1;
  result_.runs[0].methods = {{"fair", 1.5}, {"guo", 1}};
  result_.runs[2].time_after_s = 1;
  result_.runs[2].methods = {{"fair", 1}, {"guo", 1.1}};
  result_.runs[4].methods = {{"fair", 1}, {"guo", 2}};
  EXPECT_TRUE(says("guo in 1 run, fair in 1 run: 0.60 s less than by the next best ones"))
      << text();
}

TEST_F(Summary, TellsTheWorstDeviationWithItsLineAndTheLimit) {
  EXPECT_TRUE(says("at most 0.0098 mm, near line 120; allowed 0.0100 mm")) << text();
  EXPECT_TRUE(says("keeps the tolerance")) << text();
}

// 0.0098 / 25.4 = 0.000386, 0.01 / 25.4 = 0.000394.
TEST_F(Summary, TellsInchesOfAnInchProgram) {
  result_.units = gcode::Units::kInch;
  EXPECT_TRUE(says("0.0098 mm (0.00039 in)")) << text();
}

TEST_F(Summary, ClaimsNoProofWithoutOne) {
  result_.proved = false;
  EXPECT_TRUE(says("NOT PROVED")) << text();
  EXPECT_FALSE(says("keeps the tolerance")) << text();
}

TEST_F(Summary, ClaimsNothingWhereNothingWasRewritten) {
  for (RunReport& run : result_.runs) {
    run.status = RunStatus::kKept;
    run.reason = gcode::reason::kNoGain;
  }
  result_.text = std::string(source_.text());
  result_.blocks_out = result_.blocks_in;
  EXPECT_TRUE(says("0 rewritten, 5 kept")) << text();
  EXPECT_TRUE(says("200, unchanged")) << text();
  EXPECT_TRUE(says("every block is as it was")) << text();
}

}  // namespace
}  // namespace batten::postproc
