// What the reports of `batten smooth` tell of five runs, to people and to programs.
#include "postproc/report/smooth_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/report_words.h"

namespace batten::postproc {
namespace {

class SmoothReports : public testing::Test {
 protected:
  [[nodiscard]] SmoothReport report() const {
    return {
        .source = source_, .options = options_, .result = result_, .output_file = "part.smooth.nc"};
  }
  [[nodiscard]] std::string text() const { return summary_text(report()); }
  [[nodiscard]] bool says(std::string_view words) const {
    return text().find(words) != std::string::npos;
  }
  [[nodiscard]] Json json() const { return Json::parse(json_report(report())); }

  gcode::SourceText source_{"part.nc", "G21\nG1 X1\nG1 X2\n" + std::string(84, '\n')};
  SmoothOptions options_ = linuxcnc_options();
  SmoothResult result_ = five_runs();
};

class Summary : public SmoothReports {};
class JsonReport : public SmoothReports {};

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

// --- for programs --------------------------------------------------------------------------------

std::vector<std::string> keys_of(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

TEST_F(JsonReport, HasItsFieldsInAFixedOrder) {
  const Json report = json();
  EXPECT_EQ(keys_of(report),
            (std::vector<std::string>{"batten", "options", "input", "output", "machine", "runs",
                                      "reasons", "deviation_mm", "deviation_line", "corner_mm",
                                      "time_before_s", "time_after_s", "proved", "understood",
                                      "diagnostics"}));
  EXPECT_EQ(keys_of(report["input"]),
            (std::vector<std::string>{"file", "bytes", "blocks", "units"}));
  EXPECT_EQ(keys_of(report["output"]),
            (std::vector<std::string>{"file", "bytes", "blocks", "target"}));
  EXPECT_EQ(keys_of(report["runs"][0]),
            (std::vector<std::string>{"first_line", "last_line", "points", "status", "reason",
                                      "method", "methods", "form", "blocks_in", "blocks_out",
                                      "deviation_mm", "proved", "noise_mm", "max_curvature_before",
                                      "max_curvature_after", "time_before_s", "time_after_s"}));
}

TEST_F(JsonReport, TellsWhoseTimesItsTimesAre) {
  const Json machine = json()["machine"];
  EXPECT_EQ(machine["name"], "linuxcnc");
  EXPECT_EQ(machine["model"], "linuxcnc");
  EXPECT_EQ(machine["description"], find_machine("linuxcnc")->description);
}

TEST_F(JsonReport, TellsWhatEachMethodWouldTake) {
  result_.runs[0].methods = {{"fair", 1.5}, {"guo", 1.25}};
  const Json run = json()["runs"][0];
  ASSERT_EQ(run["methods"].size(), 2u);
  EXPECT_EQ(run["methods"][1]["method"], "guo");
  EXPECT_EQ(run["methods"][1]["time_s"], 1.25);
  EXPECT_TRUE(json()["runs"][1]["methods"].empty());
}

TEST_F(JsonReport, TellsTheFiguresOfTheResult) {
  const Json report = json();
  EXPECT_EQ(report["batten"], BATTEN_VERSION);
  EXPECT_EQ(report["input"]["file"], "part.nc");
  EXPECT_EQ(report["input"]["bytes"], 100);
  EXPECT_EQ(report["input"]["blocks"], 200);
  EXPECT_EQ(report["input"]["units"], "mm");
  EXPECT_EQ(report["output"]["file"], "part.smooth.nc");
  EXPECT_EQ(report["output"]["bytes"], 10);
  EXPECT_EQ(report["output"]["blocks"], 50);
  EXPECT_EQ(report["output"]["target"], "linuxcnc");
  EXPECT_EQ(report["options"]["tolerance_mm"], 0.01);
  EXPECT_EQ(report["deviation_mm"], 0.0098);
  EXPECT_EQ(report["deviation_line"], 120);
  EXPECT_EQ(report["time_before_s"], 4.0);
  EXPECT_EQ(report["time_after_s"], 2.0);
  EXPECT_EQ(report["proved"], true);
}

TEST_F(JsonReport, TellsOfEachRunWhatBecameOfIt) {
  const Json runs = json()["runs"];
  ASSERT_EQ(runs.size(), 5u);
  EXPECT_EQ(runs[0]["status"], "rewritten");
  EXPECT_EQ(runs[0]["form"], "lines");
  EXPECT_EQ(runs[0]["reason"], "");
  EXPECT_EQ(runs[1]["status"], "kept");
  EXPECT_EQ(runs[1]["form"], "");
  EXPECT_EQ(runs[1]["reason"], "too-short");
  EXPECT_EQ(runs[2]["form"], "arcs");
}

// The reason with the most blocks first: 10 blocks of exact-stop, then 2 + 3 of too-short.
TEST_F(JsonReport, CountsTheReasons) {
  const Json reasons = json()["reasons"];
  ASSERT_EQ(reasons.size(), 2u);
  EXPECT_EQ(reasons[0]["id"], "exact-stop");
  EXPECT_EQ(reasons[0]["runs"], 1);
  EXPECT_EQ(reasons[0]["blocks"], 10);
  EXPECT_EQ(reasons[0]["can_be_allowed"], true);
  EXPECT_EQ(reasons[1]["id"], "too-short");
  EXPECT_EQ(reasons[1]["runs"], 2);
  EXPECT_EQ(reasons[1]["blocks"], 5);
  EXPECT_FALSE(reasons[1]["text"].get<std::string>().empty());
}

TEST_F(JsonReport, PlacesDiagnosticsByLineAndColumn) {
  result_.diagnostics.push_back({.severity = gcode::Severity::kWarning,
                                 .id = "some-id",
                                 .where = {.begin = 7, .end = 9},
                                 .message = "found 1, expected 2"});
  const Json diagnostic = json()["diagnostics"][0];
  EXPECT_EQ(diagnostic["severity"], "warning");
  EXPECT_EQ(diagnostic["id"], "some-id");
  EXPECT_EQ(diagnostic["line"], 2);
  EXPECT_EQ(diagnostic["column"], 4);
  EXPECT_EQ(diagnostic["message"], "found 1, expected 2");
}

TEST_F(JsonReport, IsTheSameForAnyNumberOfThreads) {
  const std::string before = json_report(report());
  options_.threads = 7;
  EXPECT_EQ(json_report(report()), before);
}

TEST_F(JsonReport, SurvivesNamesThatAreNotUtf8) {
  source_ = gcode::SourceText("Fr\xE4se.nc", "G21\n");
  EXPECT_EQ(json()["input"]["file"], "Fr\xEF\xBF\xBDse.nc");
}

}  // namespace
}  // namespace batten::postproc
