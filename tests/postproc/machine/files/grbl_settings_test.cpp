#include "postproc/machine/files/grbl_settings.h"

#include <gtest/gtest.h>

namespace batten::postproc {
namespace {

struct Read {
  std::optional<Machine> machine;
  std::string problems;  // one a line
};

Read read(std::string_view dump) {
  std::vector<std::string> problems;
  Read result{with_grbl_settings(*find_machine("router"), dump, "dump.txt", problems), {}};
  for (const std::string& problem : problems) result.problems += problem + "\n";
  return result;
}

// All that time depends on; each line may be replaced.
std::string dump_with(const std::string& line = "") {
  std::string text = "$11=0.020\r\n$12=0.003\r\n";
  for (const char* axis : {"0=5000.000", "1=4000.000", "2=600.000"}) {
    text += std::string("$11") + axis + "\r\n";
  }
  for (const char* axis : {"0=300.000", "1=250.000", "2=50.000"}) {
    text += std::string("$12") + axis + "\r\n";
  }
  return text + line;
}

void expect_the_machine_of_the_dump(const Machine& m) {
  EXPECT_EQ(m.model, ControllerModel::kGrbl);
  EXPECT_DOUBLE_EQ(m.junction_deviation, 0.02);
  EXPECT_DOUBLE_EQ(m.arc_tolerance, 0.003);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kX).velocity, 5000.0 / 60);  // $110 is in mm/min
  EXPECT_DOUBLE_EQ(m.axis(Axis::kY).velocity, 4000.0 / 60);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kZ).velocity, 10);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kZ).rapid_velocity, 10) << "grbl has one limit for both";
  EXPECT_DOUBLE_EQ(m.axis(Axis::kX).acceleration, 300);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kY).acceleration, 250);
  EXPECT_DOUBLE_EQ(m.axis(Axis::kZ).acceleration, 50);
}

TEST(GrblSettings, AreThoseOfTheDump) {
  const Read result = read(dump_with());
  ASSERT_TRUE(result.machine.has_value()) << result.problems;
  expect_the_machine_of_the_dump(*result.machine);
}

TEST(GrblSettings, KeepWhatTheDumpDoesNotSay) {
  const Read result = read(dump_with());
  ASSERT_TRUE(result.machine.has_value()) << result.problems;
  const Machine& router = *find_machine("router");
  EXPECT_EQ(result.machine->stream_rate, router.stream_rate);
  EXPECT_EQ(result.machine->look_ahead, router.look_ahead);
  EXPECT_EQ(result.machine->axis(Axis::kA), router.axis(Axis::kA));
}

// What stands around the settings in the log of a sender: all of it is passed over.
TEST(GrblSettings, StandAmongAnswersAndComments) {
  const std::string dump =
      "\xEF\xBB\xBF"
      "; saved by hand\n"
      "\n"
      "Grbl 1.1h ['$' for help]\n"
      "[MSG:'$H'|'$X' to unlock]\n"
      ">>> $$\n"
      "$$\n"
      "<Idle|MPos:0.000,0.000,0.000|FS:0,0>\n"
      "$0=10\n$1=25 (step idle delay, msec)\n$13=1 (report inches, bool)\n$32=1\n"
      "  $11 = 0.020 (junction deviation, mm)\n"
      "$12=0.003 (arc tolerance, mm)\n"
      "$100=250.000 (x, step/mm)\n"
      "$110=5000.000 (x max rate, mm/min)\n$111=4000.000\n$112=600\n"
      "$120=300.000 (x accel, mm/sec^2)\n$121=250.000 ; mm/sec^2\n$122=50.000\n"
      "$130=800.000 (x max travel, mm)\n"
      "$N0=G21 G90\n"
      "ok\n";
  const Read result = read(dump);
  ASSERT_TRUE(result.machine.has_value()) << result.problems;
  expect_the_machine_of_the_dump(*result.machine);
}

// grblHAL: axes beyond Z, and settings that are texts or lists.
TEST(GrblSettings, OfGrblHalHaveMoreAxes) {
  const Read result =
      read(dump_with("$70=7\n$74=home network\n$302=192.168.5.1\n$341=0\n"
                     "$113=3600.000\n$123=500.000\n$660=,\n"));
  ASSERT_TRUE(result.machine.has_value()) << result.problems;
  expect_the_machine_of_the_dump(*result.machine);
  EXPECT_DOUBLE_EQ(result.machine->axis(Axis::kA).velocity, 60);  // degrees/s
  EXPECT_DOUBLE_EQ(result.machine->axis(Axis::kA).acceleration, 500);
}

TEST(GrblSettings, CountAsTheyAreLast) {
  const Read result = read("$110=1\n" + dump_with());
  ASSERT_TRUE(result.machine.has_value()) << result.problems;
  expect_the_machine_of_the_dump(*result.machine);
}

struct BadDump {
  const char* name;
  const char* line;  // behind eight good ones
  const char* problem;
};

class BadDumps : public testing::TestWithParam<BadDump> {};

TEST_P(BadDumps, AreToldWithPlaceAndSetting) {
  const Read result = read(dump_with(GetParam().line));
  EXPECT_FALSE(result.machine.has_value());
  EXPECT_EQ(result.problems, std::string("dump.txt:") + GetParam().problem + "\n");
}

INSTANTIATE_TEST_SUITE_P(
    GrblSettings, BadDumps,
    testing::Values(
        BadDump{"NoRate", "$110=0.000", "9:6: $110: 0, expected above 0 (mm/s)"},
        BadDump{"NegativeAcceleration", "  $122 = -5", "9:10: $122: -5, expected above 0 (mm/s2)"},
        BadDump{"NoJunctionDeviation", "$11=0", "9:5: $11: 0, expected above 0 (mm)"},
        BadDump{"NoNumber", "$12=abc", "9:1: '$12=abc', expected a setting such as $110=5000.000"},
        BadDump{"ACommaForThePoint", "$120=10,5",
                "9:1: '$120=10,5', expected a setting such as $110=5000.000"},
        BadDump{"Nothing", "$110=", "9:1: '$110=', expected a setting such as $110=5000.000"},
        BadDump{"AProgram", "G21 G90", "9:1: 'G21 G90', expected a setting such as $110=5000.000"},
        BadDump{"AnError", "error:8",
                "9:1: 'error:8' is what a control answers that prints no settings"},
        BadDump{"AnAlarm", "ALARM: 1",
                "9:1: 'ALARM: 1' is what a control answers that prints no settings"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(GrblSettings, ThatAreMissingAreToldTogether) {
  const Read result = read("$11=0.010\n$110=500\n$111=500\n$120=10\n$121=10\n$122=10\nok\n");
  EXPECT_FALSE(result.machine.has_value());
  EXPECT_EQ(result.problems,
            "dump.txt: no $12, $112 in it, expected all that grbl prints when asked for $$\n");
  EXPECT_FALSE(read("").machine.has_value());
}

}  // namespace
}  // namespace batten::postproc
