#include "postproc/report/json_report.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/report_words.h"

namespace batten::postproc {
namespace {

using Json = nlohmann::ordered_json;

class JsonReport : public testing::Test {
 protected:
  [[nodiscard]] std::string text() const {
    return json_report({.source = source_,
                        .options = options_,
                        .result = result_,
                        .output_file = "part.smooth.nc"});
  }
  [[nodiscard]] Json json() const { return Json::parse(text()); }

  gcode::SourceText source_{"part.nc", "G21\nG1 X1\nG1 X2\n"};
  SmoothOptions options_ = linuxcnc_options();
  SmoothResult result_ = five_runs();
};

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
  EXPECT_EQ(report["input"]["bytes"], 16);
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
  const std::string before = text();
  options_.threads = 7;
  EXPECT_EQ(text(), before);
}

TEST_F(JsonReport, SurvivesNamesThatAreNotUtf8) {
  source_ = gcode::SourceText("Fr\xE4se.nc", "G21\n");
  EXPECT_EQ(json()["input"]["file"], "Fr\xEF\xBF\xBDse.nc");
}

}  // namespace
}  // namespace batten::postproc
