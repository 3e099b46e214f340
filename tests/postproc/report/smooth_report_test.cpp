// What the reports of `batten smooth` tell of five runs, to people and to programs.
#include "postproc/report/smooth_report.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/report_words.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

class SmoothReports : public testing::Test {
 protected:
  [[nodiscard]] SmoothReport report() const {
    return {
        .source = source_, .options = options_, .result = result_, .output_file = "part.smooth.nc"};
  }
  [[nodiscard]] Json json() const { return Json::parse(json_report(report())); }

  gcode::SourceText source_{"part.nc", "G21\nG1 X1\nG1 X2\n" + std::string(84, '\n')};
  SmoothOptions options_ = linuxcnc_options();
  SmoothResult result_ = five_runs();
};

using Parts = std::vector<const char*>;

// What the summary says, and does not say, of a result that differs from the five runs.
struct SummaryCase {
  const char* name;
  void (*change)(SmoothResult&);
  Parts says;
  Parts says_not = {};
};

void find_nothing(SmoothResult& result) {
  result.program_after = result.program_before;
  result.runs_after_s = result.runs_before_s;
  result.blocks_out = result.blocks_in;
  result.path_before = result.path_after = {100, 0.001, 0.1};
}

const SummaryCase kSummaries[] = {
    {"AsItIs",
     [](SmoothResult&) {},
     {"part.nc -> part.smooth.nc, for linuxcnc\n",
      // 200 -> 50 blocks are 75 % less, 100 -> 10 bytes 90 %.
      "200 -> 50  (-75 %)", "100 -> 10  (-90 %)", "2 rewritten, 3 kept",
      "kept: 10 moves, 20.0 % of the cutting length, since line 181 'G61' and 1 more "
      "(exact-stop): ",
      "--allow exact-stop lifts this rule",
      "kept: 5 moves, 1.5 % of the cutting length, first in line 182 'G1 X5' (too-short): ",
      "4.00 s -> 2.00 s  (machine linuxcnc, 2.0 times as fast)",
      "50.0 -> 12.5 % of the cutting time is below half of the programmed feed",
      "at most 0.0098 mm, near line 120; allowed 0.0100 mm", "keeps the tolerance"},
     // One method alone wins nothing.
     {"--allow too-short", "methods"}},
    {"CausesInMoves",
     [](SmoothResult& result) { result.kept.all.without_length = 7; },
     // 10 of 175.
     {"kept: 10 moves, 5.7 % of the cutting moves, since line 181"}},
    {"OtherCauses",
     [](SmoothResult& result) { result.kept.causes.resize(5, result.kept.causes[1]); },
     {"kept: 10 moves, 3.0 % of the cutting length, for 2 other reasons: see --json"}},
    // What is printed as zero has no percent.
    {"DistanceOfAnExactPath",
     [](SmoothResult& result) {
       result.path_before = {100, 4e-5, 0.1};
       result.path_after = {100, 0.0017, 0.1};
     },
     {"0.0000 -> 0.0017 mm  (rms, from the path that was meant)"}},
    {"DistanceOfARoughPath",
     [](SmoothResult& result) {
       result.path_before = {100, 6e-5, 0.1};
       result.path_after = {100, 3e-5, 0.1};
     },
     {"0.0001 -> 0.0000 mm  (rms, from the path that was meant, -50 %)"}},
    {"NothingFound",
     [](SmoothResult& result) {
       result.runs.clear();
       result.kept.any_run = false;
     },
     {"for linuxcnc: nothing to smooth: 20.0 % of the cutting length, since line 181 'G61'"}},
    {"NothingThatCuts",
     [](SmoothResult& result) {
       result.runs.clear();
       result.kept = {};
     },
     {"for linuxcnc: nothing to smooth: no cutting move in X, Y or Z was found\n"}},
    {"Expressions",
     [](SmoothResult& result) { result.runs[0].computed_blocks = 1; },
     {"1 block with expressions of variables became numbers", "--keep-expressions"}},
    {"LongTimes",
     [](SmoothResult& result) {
       result.program_before.seconds = 7300;
       result.program_after.seconds = 6570;
     },
     {"2 h 01 min -> 1 h 49 min  (machine linuxcnc, -10.0 %)"}},
    // One run by guo, 0.5 s before fair; one by fair, 0.1 s before guo. Kept runs do not count.
    {"MethodsThatWon",
     [](SmoothResult& result) {
       result.runs[0].method = "guo";
       result.runs[0].time_after_s = 1;
       result.runs[0].methods = {{"fair", 1.5}, {"guo", 1}};
       result.runs[2].time_after_s = 1;
       result.runs[2].methods = {{"fair", 1}, {"guo", 1.1}};
       result.runs[4].methods = {{"fair", 1}, {"guo", 2}};
     },
     {"guo in 1 run, fair in 1 run: 0.60 s less than by the next best ones"}},
    // 0.0098 / 25.4 = 0.000386, 0.01 / 25.4 = 0.000394.
    {"Inches",
     [](SmoothResult& result) { result.units = gcode::Units::kInch; },
     {"0.0098 mm (0.00039 in)"}},
    {"NotProved",
     [](SmoothResult& result) { result.proved = false; },
     {"NOT PROVED"},
     {"keeps the tolerance"}},
    {"NothingRewritten",
     [](SmoothResult& result) {
       for (RunReport& run : result.runs) {
         run.status = RunStatus::kKept;
         run.reason = gcode::reason::kNoGain;
       }
       result.blocks_out = result.blocks_in;
     },
     {"0 rewritten, 5 kept", "200, unchanged", "every block is as it was"}},
    // Of 200 blocks 100 fewer; (0.002 mm)^2 over 100 mm is 3e-4 more than (0.001 mm)^2.
    {"OutlookOnAnotherForm",
     [](SmoothResult& result) {
       find_nothing(result);
       result.outlook.others.row(2) << 0, -100, 3e-4;
     },
     {"--output arcs: 50 % fewer blocks, 100 % farther from the path"},
     {"--prefer", "the program is good"}},
    {"OutlookOnWhatWasWritten",
     [](SmoothResult& result) {
       find_nothing(result);
       for (const int auto_or_time : {0, 4}) {
         result.outlook.others.row(auto_or_time) << 0, -100, 0;
       }
     },
     {},
     {"--prefer", "--output", "the program is good"}},
    {"OutlookAtItsFeeds",
     [](SmoothResult& result) {
       find_nothing(result);
       result.outlook.at_feeds_s = 0.995 * result.runs_before_s;
     },
     {"the program is good here"}},
    {"OutlookOnABetterForm",
     [](SmoothResult& result) {
       find_nothing(result);
       result.outlook = {.at_feeds_s = result.runs_before_s, .better = 1};
     },
     {},
     {"the program is good", "found"}},
};

// Without the rule 1 s in place of 2 s, and 60 blocks in place of 50.
TEST_F(SmoothReports, SayWhatLiftingARuleWouldWin) {
  EXPECT_EQ(rule_worth_lifting(result_), gcode::reason::kExactStop);
  LiftedRule lifted{gcode::reason::kExactStop, result_};
  lifted.result.program_after.seconds = 1;
  lifted.result.blocks_out = 60;
  SmoothReport with = report();
  with.lifted = &lifted;
  const char* won = "found         --allow exact-stop: 50 % less time, 20 % more blocks\n";
  EXPECT_NE(summary_text(with).find(won), std::string::npos) << summary_text(with);
  lifted.result.program_after.seconds = 2;
  EXPECT_EQ(summary_text(with), summary_text(report())) << "it would win nothing";
}

// Nor a rule whose lifting adds tolerances, nor one that keeps little.
TEST_F(SmoothReports, NoRuleIsWorthLiftingThatKeepsLittle) {
  result_.kept.causes[0].reason = gcode::reason::kAlreadySmoothed;
  EXPECT_EQ(rule_worth_lifting(result_), "");
  result_ = five_runs();
  result_.kept.causes[0].cut.length_mm /= 10;
  EXPECT_EQ(rule_worth_lifting(result_), "");
}

TEST_F(SmoothReports, SayToPeopleWhatBecameOfTheProgram) {
  for (const SummaryCase& test : kSummaries) {
    result_ = five_runs();
    test.change(result_);
    const std::string text = summary_text(report());
    for (const char* words : test.says) {
      EXPECT_NE(text.find(words), std::string::npos) << test.name << ": " << words << "\n" << text;
    }
    for (const char* words : test.says_not) {
      EXPECT_EQ(text.find(words), std::string::npos) << test.name << ": " << words << "\n" << text;
    }
  }
}

// --- for programs --------------------------------------------------------------------------------

std::string keys_of(const Json& json) {
  std::string keys;
  for (const auto& [key, value] : json.items()) keys += key + " ";
  return keys;
}

TEST_F(SmoothReports, HaveTheirFieldsInAFixedOrder) {
  const Json report = json();
  EXPECT_EQ(
      keys_of(report),
      "schema kind batten options options_from input output machine stated_tolerances runs reasons "
      "kept deviation_mm deviation_line corner_mm "
      "time_before_s time_after_s cutting_before_s cutting_after_s slow_share_before "
      "slow_share_after path_before path_after proved understood diagnostics ");
  EXPECT_EQ(keys_of(report["input"]), "file bytes blocks units ");
  EXPECT_EQ(keys_of(report["output"]), "file bytes blocks target ");
  EXPECT_EQ(
      keys_of(report["runs"][0]),
      "first_line last_line points tolerance_mm status reason method methods form blocks_in "
      "computed_blocks "
      "blocks_out "
      "deviation_mm proved cut_short noise_mm coarse_part max_curvature_before max_curvature_after "
      "bytes_in bytes_out "
      "path_before path_after time_before_s time_after_s ");
}

TEST_F(SmoothReports, SayTheFiguresOfTheResultToPrograms) {
  result_.runs[0].methods = {{"fair", 1.5}, {"guo", 1.25}};
  // Line 2, column 4.
  result_.diagnostics.push_back({.severity = gcode::Severity::kWarning,
                                 .id = "some-id",
                                 .where = {.begin = 7, .end = 9},
                                 .message = "found 1, expected 2"});
  const Json report = json();
  EXPECT_EQ(report["batten"], BATTEN_VERSION);
  EXPECT_EQ(report["input"],
            Json::parse(R"({"file": "part.nc", "bytes": 100, "blocks": 200, "units": "mm"})"));
  EXPECT_EQ(report["output"], Json::parse(R"({"file": "part.smooth.nc", "bytes": 10, "blocks": 50,
                                              "target": "linuxcnc"})"));
  EXPECT_EQ(report["machine"]["name"], "linuxcnc");
  EXPECT_EQ(report["machine"]["model"], "linuxcnc");
  EXPECT_EQ(report["machine"]["description"], find_machine("linuxcnc")->description);
  EXPECT_EQ(report["options"]["tolerance_mm"], 0.01);
  EXPECT_EQ(report["deviation_mm"], 0.0098);
  EXPECT_EQ(report["deviation_line"], 120);
  EXPECT_EQ(report["time_before_s"], 4.0);
  EXPECT_EQ(report["time_after_s"], 2.0);
  EXPECT_EQ(report["cutting_before_s"], 3.0);
  EXPECT_EQ(report["slow_share_after"], 0.125);
  EXPECT_EQ(report["proved"], true);
  EXPECT_EQ(report["diagnostics"],
            Json::parse(R"([{"severity": "warning", "id": "some-id", "line": 2, "column": 4,
                             "message": "found 1, expected 2", "advice": ""}])"));
  const Json runs = report["runs"];
  ASSERT_EQ(runs.size(), 5u);
  const auto of_runs = [&](const char* field) {
    std::string all;
    for (const Json& run : runs) all += run[field].get<std::string>() + ",";
    return all;
  };
  EXPECT_EQ(of_runs("status"), "rewritten,kept,rewritten,kept,kept,");
  EXPECT_EQ(of_runs("form"), "lines,,arcs,,,");
  EXPECT_EQ(of_runs("reason"), ",too-short,,too-short,exact-stop,");
  EXPECT_EQ(runs[0]["methods"], Json::parse(R"([{"method": "fair", "time_s": 1.5},
                                                {"method": "guo", "time_s": 1.25}])"));
  EXPECT_TRUE(runs[1]["methods"].empty());
  // The reason with the most blocks first: 10 blocks of exact-stop, then 2 + 3 of too-short.
  const Json reasons = report["reasons"];
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

TEST_F(SmoothReports, AreTheSameForAnyNumberOfThreads) {
  const std::string before = json_report(report());
  options_.threads = 7;
  EXPECT_EQ(json_report(report()), before);
}

TEST_F(SmoothReports, SurviveNamesThatAreNotUtf8) {
  source_ = gcode::SourceText("Fr\xE4se.nc", "G21\n");
  EXPECT_EQ(json()["input"]["file"], "Fr\xEF\xBF\xBDse.nc");
}

// Teeth of 1 mm, all corners, and behind them a wave in 1 mm steps, whose chords are fine where it
// bends least. Kept in parts they are one run of the report, as where nothing is tried.
TEST(RunReports, SayWhereChordsAreCoarserThanTheTolerance) {
  std::string text = head("G21");
  for (int i = 1; i <= 200; ++i) {
    text += fmt::format("{}X{} Y{}\n", i == 1 ? "G1 F300 " : "", i, i % 2);
  }
  for (int i = 201; i <= 800; ++i) text += fmt::format("X{} Y{:.4f}\n", i, std::sin(0.1 * i));
  text += tail();
  const auto coarse_part = [&text](double tolerance, Method method) {
    SmoothOptions options = options_for("grbl");
    options.tolerance_mm = tolerance;
    options.method = method;
    const SmoothResult result = smoothed(text, options);
    EXPECT_EQ(rewritten_runs(result), 0U);
    EXPECT_EQ(result.runs.back().points, 801U);
    return result.runs.back().coarse_part;
  };
  EXPECT_NEAR(coarse_part(0.01, Method::kNone), 0.25, 0.01);
  const double whole = coarse_part(0.001, Method::kNone);
  EXPECT_GT(whole, 0.3);
  EXPECT_NEAR(coarse_part(0.001, Method::kFair), whole, 0.01);
}

}  // namespace
}  // namespace batten::postproc
