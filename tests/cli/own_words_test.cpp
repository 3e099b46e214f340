// Words of the shop, as a user meets them.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "batten_process.h"
#include "tests/support/wavy_programs.h"

namespace batten {
namespace {

// What smooth would find: the modes that the control lacks are not asked for.
TEST(InspectForATarget, ReadsTheProgramAsThatControl) {
  const BattenFolder folder;
  folder.put("part.nc", "G21 G90 G17 G94\nG0 X0 Y0 Z5\nG777\nX1 Y1\nX2 Y2\nM30\n");
  expect_exit(folder.batten("inspect part.nc"), 0, {"mirroring (G50.1)"});
  expect_exit(folder.batten("inspect part.nc --target grbl"), 0,
              {"of them: units (G20 or G21), plane (G17), distance (G90), feed mode (G94). "});
}

constexpr const char* kWord = " --word 'M501 = keeps state'";

// A wave behind a word that no control shares.
class OwnWordsOfAUser : public testing::Test {
 protected:
  void SetUp() override {
    const std::string wave = postproc::joined(postproc::wave_lines({}), "\n");
    folder_.put("part.nc", "G21 G90 G17\nS12000 M3\nG0 X0. Y0. Z5.\nG1 Z-1. F300.\nG777\n" + wave +
                               "M501\nG1 X40. Y9. F2000\nX0. Y9.\nX0. Y0.\n" + wave +
                               "G0 Z5.\nM30\n");
    folder_.put(
        "shop.toml",
        "based-on = \"haas\"\n[own-words]\nG777 = \"keeps state\"\nM501 = \"ends a run\"\n");
  }
  BattenFolder folder_;
};

TEST_F(OwnWordsOfAUser, AreTakenByEveryCommandAndNamedByIt) {
  const std::string smooth = "smooth part.nc --tolerance 0.01 --json report.json --force -o ";
  expect_exit(folder_.batten(smooth + "kept.nc --target haas"), 0);
  EXPECT_EQ(folder_.text_of("kept.nc"), folder_.text_of("part.nc"));
  expect_exit(folder_.batten(smooth + "new.nc --target shop.toml"), 0,
              {"2 rewritten", "vouched for   G777: keeps state", "M501: ends a run"});
  const auto report = nlohmann::json::parse(folder_.text_of("report.json"));
  EXPECT_EQ(report["options"]["words"][0]["word"], "G777");
  EXPECT_EQ(report["options"]["words"][1]["effect"], "ends a run");
  EXPECT_TRUE(contains(folder_.text_of("new.nc"), "\nG777\n"));
  EXPECT_TRUE(contains(folder_.text_of("new.nc"), "\nM501\n"));

  const std::string verify = "verify part.nc new.nc --tolerance 0.01";
  EXPECT_EQ(folder_.batten(verify).exit_code, 3);
  EXPECT_EQ(folder_.batten(verify + kWord).exit_code, 3);  // of G777 nothing is said
  expect_exit(folder_.batten(verify + " --profile shop.toml"), 0, {"vouched for"});

  EXPECT_TRUE(contains(folder_.batten("inspect part.nc").out, "no run"));
  EXPECT_TRUE(contains(folder_.batten("inspect part.nc --profile shop.toml").out,
                       "2 runs that may be rewritten"));
  const std::string time = "time part.nc --machine mill";
  EXPECT_TRUE(contains(folder_.batten(time).out, "not timed"));
  const ProcessResult timed = folder_.batten(time + " --target shop.toml --json time.json");
  EXPECT_TRUE(contains(timed.out, "vouched for")) << timed.out << timed.err;
  EXPECT_EQ(nlohmann::json::parse(folder_.text_of("time.json"))["words"].size(), 2U);
}

TEST_F(OwnWordsOfAUser, AreTakenFromTheCommandLineAndFromConfigurations) {
  const std::string words = " --word 'G777 = keeps state' --word 'G65 P9810 = moves, returns'";
  const ProcessResult config = folder_.batten("smooth --print-config --target haas" + words);
  EXPECT_TRUE(contains(config.out, R"("G65 P9810 = moves, returns")")) << config.out;
  folder_.put("batten.cfg.toml", config.out);
  expect_exit(folder_.batten("smooth part.nc --config batten.cfg.toml -o new.nc"), 0,
              {"G65 P9810: moves, returns"});
}

// A batch that is told more of a word makes its programs again.
TEST_F(OwnWordsOfAUser, AreSettingsOfABatch) {
  expect_exit(folder_.shell("mkdir in && cp part.nc in/"), 0);
  const std::string batch = "batch in out --target haas";
  expect_exit(folder_.batten(batch), 0);
  EXPECT_EQ(folder_.text_of("out/part.nc"), folder_.text_of("part.nc"));
  expect_exit(folder_.batten(batch + " --word 'G777 = keeps state'" + kWord), 0);
  EXPECT_NE(folder_.text_of("out/part.nc"), folder_.text_of("part.nc"));
}

TEST_F(OwnWordsOfAUser, ThatAreWrongAreToldAllAtOnce) {
  folder_.put(
      "bad.toml",
      "based-on = \"haas\"\n[own-words]\nM8 = \"keeps state\"\nM501 = \"spins\"\nM77 = 5\n");
  const ProcessResult said =
      expect_exit(folder_.batten("smooth part.nc --target bad.toml --word 'M502 = sleeps'"), 1,
                  {"bad.toml:3:6: own-words.M8", "Batten knows what M8 does",
                   "bad.toml:4:8: own-words.M501", "there is no effect 'spins'",
                   "bad.toml:5:7: own-words.M77: 5", "there is no effect 'sleeps'"});
  EXPECT_FALSE(folder_.has("part.smooth.nc")) << said.err;
}

}  // namespace
}  // namespace batten
