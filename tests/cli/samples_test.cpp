// Every folder of samples/ holds what its expected.json says, whatever else changes.
//
//   {"exit_code": 0,
//    "runs_rewritten": [least, most],
//    "kept": {"reason-id": [least, most]},   every reason that occurs must stand here
//    "blocks_out": [least, most],
//    "deviation_mm_at_most": 0.01,
//    "time_ratio_at_most": 1.0,              time after / time before, by the machine model
//    "keeps": ["text that must stand in the new program"]}

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "batten_process.h"
#include "tests/support/places.h"

namespace batten {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path samples_folder() { return fs::path(BATTEN_SOURCE_DIR) / "samples"; }

std::vector<std::string> sample_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(samples_folder())) {
    if (entry.is_directory()) names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

void expect_in_range(const Json& value, const Json& range, const std::string& what) {
  EXPECT_GE(value.get<double>(), range[0].get<double>()) << what;
  EXPECT_LE(value.get<double>(), range[1].get<double>()) << what;
}

// The one line of `command`, without its last line end.
std::string command_of(const std::string& sample) {
  std::string command = text_of_file(samples_folder() / sample / "command");
  while (!command.empty() && command.back() == '\n') command.pop_back();
  return command;
}

// The word after --tolerance.
std::string tolerance_in(const std::string& command) {
  const std::string option = "--tolerance ";
  const std::size_t begin = command.find(option) + option.size();
  return command.substr(begin, command.find(' ', begin) - begin);
}

class Sample : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    folder_.put("program.ngc", text_of_file(samples_folder() / GetParam() / "program.ngc"));
    command_ = command_of(GetParam());
    ASSERT_TRUE(command_.starts_with("batten smooth program.ngc ")) << command_;
  }

  // With what is asked for besides; returns the new program.
  [[nodiscard]] std::string smoothed(const std::string& more) const {
    expect_exit(folder_.shell(command_ + more), 0);
    return folder_.text_of("program.smooth.ngc");
  }

  BattenFolder folder_;
  std::string command_;
};

TEST_P(Sample, ComesOutAsExpectedIsAcceptedByVerifyAndStaysForASecondPassAndTwoThreads) {
  const Json expected = Json::parse(text_of_file(samples_folder() / GetParam() / "expected.json"));
  EXPECT_EQ(expected["exit_code"], 0);
  const std::string text = smoothed(" --threads 1 --json one.json");
  const Json report = Json::parse(folder_.text_of("one.json"));
  std::map<std::string, int> kept;
  int rewritten = 0;
  for (const Json& run : report["runs"]) {
    if (run["status"] == "rewritten") {
      ++rewritten;
      EXPECT_EQ(run["proved"], true) << run;
    } else {
      ++kept[run["reason"].get<std::string>()];
    }
  }
  expect_in_range(rewritten, expected["runs_rewritten"], "runs rewritten");
  for (const auto& [reason, count] : kept) {
    EXPECT_TRUE(expected["kept"].contains(reason)) << count << " runs kept: " << reason;
  }
  for (const auto& [reason, range] : expected["kept"].items()) {
    expect_in_range(kept[reason], range, "runs kept: " + reason);
  }
  expect_in_range(report["output"]["blocks"], expected["blocks_out"], "blocks out");
  EXPECT_LE(report["deviation_mm"], expected["deviation_mm_at_most"]);
  EXPECT_EQ(report["proved"], true);
  if (report["time_before_s"] > 0) {
    EXPECT_LE(report["time_after_s"].get<double>(),
              report["time_before_s"].get<double>() * expected["time_ratio_at_most"].get<double>());
  }
  for (const Json& part : expected["keeps"]) {
    EXPECT_NE(text.find(part.get<std::string>()), std::string::npos) << part;
  }
  expect_exit(
      folder_.batten("verify program.ngc program.smooth.ngc --tolerance " + tolerance_in(command_)),
      0);
  std::string again = command_;
  again.replace(again.find("program.ngc"), 11, "program.smooth.ngc");
  const ProcessResult second = expect_exit(folder_.shell(again + " -o again.ngc"), 0);
  EXPECT_TRUE(folder_.text_of("again.ngc") == text) << second.err;
  EXPECT_TRUE(smoothed(" --threads 2 --force --json two.json") == text) << "two threads";
  EXPECT_EQ(folder_.text_of("one.json"), folder_.text_of("two.json"));
}

// What `smooth` and `time` predict of a program is one figure, for the old text and the new one.
TEST_P(Sample, TakesTheTimeThatBattenTimePredicts) {
  const Json listed = Json::parse(folder_.batten("machines --json -").out);
  for (const Json& machine : listed["machines"]) {
    const std::string name = " --machine " + machine["name"].get<std::string>();
    expect_exit(folder_.shell(command_ + name + " --force --json report.json"), 0);
    const Json report = Json::parse(folder_.text_of("report.json"));
    for (const auto& [file, when] :
         {std::pair("program.ngc", "before"), std::pair("program.smooth.ngc", "after")}) {
      SCOPED_TRACE(file + name);
      const auto figure = [&, when = when](const char* what, const char* unit) {
        return report[fmt::format("{}_{}{}", what, when, unit)].get<double>();
      };
      const std::string target = report["output"]["target"];
      const Json time = Json::parse(expect_exit(folder_.batten(std::string("time ") + file + name +
                                                               " --target " + target + " --json -"),
                                                0)
                                        .out);
      EXPECT_EQ(figure("time", "_s"), time["time_s"].get<double>());
      EXPECT_NEAR(figure("slow_share", "") * figure("cutting", "_s"),
                  time["below_half_feed_s"].get<double>(), 1e-12 * figure("cutting", "_s"));
    }
  }
}

TEST_P(Sample, HasAReadme) {
  EXPECT_GT(text_of_file(samples_folder() / GetParam() / "README.md").size(), 100u);
}

INSTANTIATE_TEST_SUITE_P(Samples, Sample, testing::ValuesIn(sample_names()),
                         [](const auto& test) { return test.param; });

TEST(Samples, AreWhatTheGeneratorWrites) {
  EXPECT_GE(sample_names().size(), 8u);
  const BattenFolder folder;
  const ProcessResult result =
      folder.shell("python3 '" BATTEN_SOURCE_DIR "/samples/generate.py' --check");
  if (result.exit_code == 127) GTEST_SKIP() << "python3 is not installed";
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST(Samples, AreDrawnByThePlotCommand) {
  const BattenFolder folder;
  if (folder.shell("python3 -c 'import matplotlib'").exit_code != 0) {
    GTEST_SKIP() << "matplotlib is not installed";
  }
  const std::string program = (samples_folder() / "inch_ellipse" / "program.ngc").string();
  expect_exit(folder.shell("python3 '" BATTEN_SOURCE_DIR "/samples/plot.py' '" + program + "' '" +
                           program + "' plot.png"),
              0);
  EXPECT_TRUE(folder.text_of("plot.png").starts_with("\x89PNG"));
}

}  // namespace
}  // namespace batten
