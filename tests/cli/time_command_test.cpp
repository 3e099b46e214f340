// `batten time` as a user's shell sees it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "batten_process.h"

namespace batten {
namespace {

// 50 mm from rest to rest, a dwell, a rapid; as they stand in the help.
constexpr const char* kProgram = "G21 G90\nT1 M6\nG1 X50 F6000\nG4 X0.5\nG0 X0\nM2\n";

class TimeCommandLine : public testing::Test {
 protected:
  void SetUp() override { folder_.put("part.nc", kProgram); }

  [[nodiscard]] ProcessResult time(const std::string& arguments) const {
    return folder_.batten("time part.nc " + arguments);
  }

  BattenFolder folder_;
};

TEST_F(TimeCommandLine, HelpHasExamplesAndTheColumnsOfTheProfile) {
  const ProcessResult help = expect_exit(folder_.batten("time --help"), 0);
  EXPECT_TRUE(contains(help.out, "batten time part.nc --machine linuxcnc")) << help.out;
  EXPECT_TRUE(contains(help.out, "t_s, line, x_mm")) << help.out;
}

TEST_F(TimeCommandLine, SaysWhereTheTimeGoes) {
  const ProcessResult result = expect_exit(time("--machine mill --from 0,0,0"), 0);
  for (const char* words :
       {"part.nc on mill:", "cutting", "rapids", "dwells", "below half of the programmed feed"}) {
    EXPECT_TRUE(contains(result.out, words)) << words << "\n" << result.out;
  }
}

TEST_F(TimeCommandLine, TellsTheTimeWithTheFeedOverride) {
  folder_.put("slow.nc", "G21 G90\nG1 X50 F600\nG0 X0\nM2\n");
  folder_.put("fast.nc", "G21 G90\nG1 X50 F900\nG0 X0\nM2\n");
  const std::string rest = ".nc --machine mill --from 0,0,0 --json -";
  const auto at_once = nlohmann::json::parse(folder_.batten("time fast" + rest).out);
  const auto overridden =
      nlohmann::json::parse(folder_.batten("time slow" + rest + " --feed-override 150").out);
  EXPECT_EQ(overridden.at("time_s"), at_once.at("time_s"));
  EXPECT_EQ(overridden.at("feed_override"), 1.5);
  const std::string text =
      folder_.batten("time slow.nc --machine mill --from 0,0,0 --feed-override 150").out;
  EXPECT_TRUE(contains(text, "slow.nc on mill, feeds at 150 %:")) << text;
  for (const char* wrong : {"--feed-override 0", "--feed-override fast",
                            "--feed-override 150 --bound", "--feed-override 150 --report x.html"}) {
    const ProcessResult refused =
        folder_.batten("time slow.nc --machine mill " + std::string(wrong));
    EXPECT_EQ(refused.exit_code, 1) << wrong;
    EXPECT_TRUE(contains(refused.err, "--feed-override")) << refused.err;
  }
}

TEST_F(TimeCommandLine, WritesJsonWhosePartsSumToTheWhole) {
  const ProcessResult result = expect_exit(time("--machine mill --from 0,0,0 --json -"), 0);
  const auto json = nlohmann::json::parse(result.out);
  double sum = 0;
  for (const char* part :
       {"cutting_s", "rapid_s", "dwell_s", "tool_change_s", "spindle_s", "rotary_s"}) {
    sum += json.at(part).get<double>();
  }
  EXPECT_NEAR(json.at("time_s").get<double>(), sum, 1e-9);
  EXPECT_EQ(json.at("dwell_s"), 0.5);
  EXPECT_EQ(json.at("cuts"), 1);
  EXPECT_EQ(json.at("machine"), "mill");
  EXPECT_EQ(json.at("tools").back().at("tool"), 1);
  EXPECT_TRUE(json.at("slowest").is_array());
  EXPECT_TRUE(json.at("not_timed").is_array());
}

TEST_F(TimeCommandLine, PlansByTheLimitsOfTheAxes) {
  const auto seconds = [&](const std::string& planner) {
    const ProcessResult result =
        expect_exit(time("--machine high-speed --from 0,0,0 --json - --planner " + planner), 0);
    const auto json = nlohmann::json::parse(result.out);
    EXPECT_EQ(json.at("planner"), planner);
    return json.at("cutting_s").get<double>();
  };
  // One line from rest to rest: the model of the control knows the jerk along it, too.
  EXPECT_NEAR(seconds("jerk"), seconds("control"), 1e-3 * seconds("control"));
  EXPECT_GT(seconds("s-curve"), 1.04 * seconds("jerk"));
  const ProcessResult said = expect_exit(time("--machine high-speed --planner jerk"), 0);
  EXPECT_TRUE(contains(said.out, "on high-speed, planner jerk:")) << said.out;
  expect_exit(time("--machine high-speed --planner fast"), 1, {"--planner"});
}

// The samples of a plan end where it does, a period later at the most, and meet the feed.
TEST_F(TimeCommandLine, WritesAProfileOfAPlan) {
  for (const std::string planner : {"jerk", "s-curve"}) {
    SCOPED_TRACE(planner);
    expect_exit(time("--machine high-speed --from 0,0,0 --force --json part.json --profile part.csv"
                     " --planner " +
                     planner),
                0);
    std::istringstream csv(folder_.text_of("part.csv"));
    std::string line;
    double last = 0;
    double fastest_cut = 0;
    double steepest = 0;
    for (std::getline(csv, line); std::getline(csv, line);) {
      std::istringstream row(line);
      std::vector<double> cells;
      for (std::string cell; std::getline(row, cell, ',');) cells.push_back(std::stod(cell));
      last = cells[0];
      if (cells[1] == 3) fastest_cut = std::max(fastest_cut, cells[5]);
      steepest = std::max(steepest, std::abs(cells[9]));
    }
    const auto json = nlohmann::json::parse(folder_.text_of("part.json"));
    const double seconds = json.at("time_s");
    EXPECT_GE(last, seconds - 1e-6);
    EXPECT_LE(last, seconds + 0.001 + 1e-6);
    EXPECT_NEAR(fastest_cut, 6000, 1);
    EXPECT_NEAR(steepest, 100000, 500);
  }
}

// A zigzag of 1 mm steps that turns by 90 degrees: the machine brakes in each corner.
std::string zigzag() {
  std::string text = "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 X0.7 Y0.7 F3000\n";
  for (int i = 2; i <= 60; ++i) {
    text += "X" + std::to_string(0.7 * i) + " Y" + (i % 2 == 1 ? "0.7" : "0") + "\n";
  }
  return text + "G0 X50 Y50\nM2\n";
}

// On a machine with limits on jerk both commands estimate what the plan takes.
TEST_F(TimeCommandLine, TellsTheSecondsOfSmoothWhichAreThoseOfThePlan) {
  std::string row = "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 F3000\n";
  for (int i = 1; i <= 100; ++i) {
    const double x = 0.5 * i;
    row += "X" + std::to_string(x) + " Y" + std::to_string(3 * std::sin(x / 4)) + "\n";
  }
  folder_.put("row.nc", row + "G0 Z5\nM2\n");
  const std::string machine = " --target linuxcnc --machine high-speed --json - ";
  const auto json = [&](const std::string& command) {
    return nlohmann::json::parse(expect_exit(folder_.batten(command), 0).out);
  };
  const auto seconds = [&](const std::string& file, const std::string& planner) -> double {
    return json("time " + file + machine + "--planner " + planner).at("time_s");
  };
  const auto smoothed = json("smooth row.nc -o new.nc --tolerance 0.01" + machine);
  const double before = smoothed.at("time_before_s");
  const double after = smoothed.at("time_after_s");
  EXPECT_NEAR(seconds("row.nc", "control"), before, 1e-9);
  EXPECT_NEAR(seconds("new.nc", "control"), after, 1e-9);
  EXPECT_NEAR(seconds("row.nc", "jerk"), before, 0.01 * before);
  EXPECT_NEAR(seconds("new.nc", "jerk"), after, 0.01 * after);
  EXPECT_LT(after, 0.9 * before);
}

TEST_F(TimeCommandLine, TellsWhatIsLeftToWin) {
  folder_.put("zigzag.nc", zigzag());
  const auto bounds = [&](const std::string& more) {
    const auto result =
        expect_exit(folder_.batten("time zigzag.nc --machine mill --bound --json - " + more), 0);
    return nlohmann::json::parse(result.out).at("bounds");
  };
  const auto on_path = bounds("");
  EXPECT_TRUE(on_path.at("least_within_s").is_null());
  const auto near = bounds("--tolerance 0.01");
  const auto far = bounds("--tolerance 0.1");
  EXPECT_EQ(near.at("time_s"), on_path.at("time_s"));
  EXPECT_GT(near.at("time_s").get<double>(), near.at("least_on_path_s").get<double>());
  EXPECT_GT(near.at("least_on_path_s").get<double>(), near.at("least_within_s").get<double>());
  EXPECT_GT(near.at("least_within_s").get<double>(), far.at("least_within_s").get<double>());
  ASSERT_EQ(near.at("runs").size(), 1U);
  EXPECT_EQ(near.at("runs")[0].at("first_line"), 3);
  EXPECT_EQ(near.at("runs")[0].at("last_line"), 62);
}

TEST_F(TimeCommandLine, SaysInWordsWhatIsLeftToWin) {
  folder_.put("zigzag.nc", zigzag());
  const std::string command = "time zigzag.nc --machine mill --bound --tolerance 0.01mm";
  const ProcessResult result = expect_exit(folder_.batten(command), 0);
  for (const char* words : {"to win", "in 1 run", "on a path within 0.01 mm", "lines 3-62:"}) {
    EXPECT_TRUE(contains(result.out, words)) << words << "\n" << result.out;
  }
  expect_exit(folder_.batten("time zigzag.nc --machine mill --bound --tolerance -1"), 1);
}

// A machine of LinuxCNC has its splines; whose they are on others, the target says.
TEST_F(TimeCommandLine, ReadsTheCurvesOfTheControlThatTheMachineHas) {
  folder_.put("curve.ngc",
              "G21 G90 G17\nG0 X0 Y0 Z0\nF600\nG5.2 P1 L3\nX5 Y0 P2\nX5 Y5 P1\nG5.3\nM2\n");
  const auto not_timed = [this](const std::string& on) {
    const ProcessResult result = expect_exit(folder_.batten("time curve.ngc --json - " + on), 0);
    return contains(result.out, "\"spline\"");
  };
  EXPECT_FALSE(not_timed("--machine linuxcnc"));
  EXPECT_TRUE(not_timed("--machine mill"));
  EXPECT_FALSE(not_timed("--machine mill --target linuxcnc"));
}

// Smoothing keeps moves under exact stop: none of them is in the bound, and the user hears of them.
TEST_F(TimeCommandLine, SaysWhichMovesExactStopKeepsOutOfWhatIsLeftToWin) {
  std::string text = zigzag();
  text.insert(text.find("G0 X50"), "G61\nG1 X20\nX30 Y1\nG64\nG9 X40\nG1 X50\n");
  folder_.put("stops.nc", text);
  const std::string command = "time stops.nc --machine high-speed --bound ";
  const ProcessResult result = expect_exit(folder_.batten(command), 0);
  EXPECT_TRUE(contains(result.out, "not in it: 3 moves from line 64 on, kept for exact stop"))
      << result.out;
  const auto bounds = nlohmann::json::parse(folder_.batten(command + "--json -").out).at("bounds");
  EXPECT_EQ(bounds.at("exact_stop_moves"), 3);
  EXPECT_EQ(bounds.at("runs").size(), 1U);
  folder_.put("stops.nc", zigzag());
  EXPECT_FALSE(contains(folder_.batten(command).out, "exact stop"));
}

TEST_F(TimeCommandLine, SaysWhatItDoesNotKnow) {
  const ProcessResult result = time("--machine mill");
  EXPECT_TRUE(contains(result.out, "start-unknown")) << result.out;
  EXPECT_FALSE(contains(time("--machine mill --from 0,0,0").out, "start-unknown"));
}

TEST_F(TimeCommandLine, WritesAProfileOfOneRowPerMillisecond) {
  expect_exit(time("--machine mill --from 0,0,0 --profile part.csv --json part.json"), 0);
  std::istringstream csv(folder_.text_of("part.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("t_s,line,x_mm,y_mm,z_mm,feed_mm_per_min,ax_mm_per_s2")) << line;
  int rows = 0;
  double last = -1;
  while (std::getline(csv, line)) {
    EXPECT_NEAR(std::atof(line.c_str()), 0.001 * rows, 1e-9);
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 11);
    last = std::atof(line.c_str());
    ++rows;
  }
  const auto json = nlohmann::json::parse(folder_.text_of("part.json"));
  EXPECT_NEAR(last, json.at("time_s").get<double>(), 0.001);
}

// --profile names the samples here, and --target a profile.
TEST_F(TimeCommandLine, WritesAProfileForATargetOfAFile) {
  folder_.put("mine.toml", folder_.batten("targets --show grbl").out);
  expect_exit(time("--machine mill --target mine.toml --profile part.csv"), 0);
  EXPECT_TRUE(folder_.text_of("part.csv").starts_with("t_s,line,"));
  expect_exit(time("--machine mill --target grbl --profile other.csv"), 0);
  EXPECT_EQ(folder_.text_of("other.csv"), folder_.text_of("part.csv"));
}

TEST_F(TimeCommandLine, OverwritesNothingWithoutForce) {
  folder_.put("part.csv", "mine");
  EXPECT_EQ(time("--machine mill --profile part.csv").exit_code, 4);
  EXPECT_EQ(folder_.text_of("part.csv"), "mine");
  EXPECT_EQ(time("--machine mill --profile part.csv --force").exit_code, 0);
  EXPECT_TRUE(folder_.text_of("part.csv").starts_with("t_s,"));
}

TEST_F(TimeCommandLine, WrongUsageIsExplained) {
  constexpr WrongUsage kWrong[] = {
      {"NoMachine", "part.nc", "--machine: no machine given"},
      {"UnknownMachine", "part.nc --machine mil", "did you mean 'mill'?"},
      {"UnknownTarget", "part.nc --machine mill --target linuxcn", "linuxcnc"},
      {"NoFile", "--machine mill", "FILE: no file given"},
      {"NoPlace", "part.nc --machine mill --from 1,2", "expected X,Y,Z in mm"},
      {"TwoReportsOnOneStream", "part.nc --machine mill --json - --profile -",
       "standard output already takes"},
      {"TheProgramAsProfile", "part.nc --machine mill --profile part.nc --force",
       "--profile: part.nc"},
      {"TheProgramAsReport", "part.nc --machine mill --json part.nc --force", "--json: part.nc"}};
  for (const WrongUsage& wrong : kWrong) {
    SCOPED_TRACE(wrong.name);
    expect_exit(folder_.batten(std::string("time ") + wrong.arguments), 1, {wrong.message});
    EXPECT_EQ(folder_.text_of("part.nc"), kProgram);
  }
}

TEST_F(TimeCommandLine, AsksForTheUnitsOfAProgramWithoutThem) {
  folder_.put("bare.nc", "G90\nG1 X1 F100\nM2\n");
  EXPECT_EQ(folder_.batten("time bare.nc --machine mill").exit_code, 2);
  EXPECT_EQ(folder_.batten("time bare.nc --machine mill --units inch").exit_code, 0);
}

}  // namespace
}  // namespace batten
