// `--json -` gives one JSON object on standard output for every command and every exit code.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "batten_process.h"

namespace batten {
namespace {

struct AnswerRow {
  const char* name;
  const char* arguments;
  int code;
  const char* kind;
  const char* says;  // among its messages, its diagnostics and what to do about them; "": nothing
};

const AnswerRow kAnswers[] = {
    {"Smooth", "smooth part.nc -t linuxcnc --dry-run", 0, "smooth", ""},
    {"SmoothUsage", "smooth part.nc -t linuxcnc --tolerance wide", 1, "failure", "--tolerance"},
    {"SmoothNotUnderstood", "smooth open.nc -t grbl", 2, "smooth", "--units"},
    {"SmoothNoProgram", "smooth a.out -t grbl", 2, "smooth", "not-a-program"},
    {"SmoothNoFile", "smooth none.nc -t grbl", 4, "failure", "none.nc"},
    {"SmoothNoPlace", "smooth part.nc -t grbl -o none/x.nc", 4, "failure", "none"},
    {"SmoothExists", "smooth part.nc -t grbl -o open.nc", 4, "failure", "--force"},
    {"SmoothNoPage", "smooth part.nc -t grbl --dry-run --report full.html --force", 4, "smooth",
     "No space left"},
    {"Explore", "explore part.nc -t grbl --tolerance 0.01 --output lines", 0, "explore", ""},
    {"ExploreUsage", "explore part.nc", 1, "failure", "--target"},
    {"ExploreNotUnderstood", "explore open.nc -t grbl", 2, "explore", "--units"},
    {"ExploreNoFile", "explore none.nc -t grbl", 4, "failure", "none.nc"},
    {"Verify", "verify part.nc part.nc", 0, "verify", ""},
    {"VerifyUsage", "verify part.nc", 1, "failure", "NEW"},
    {"VerifyNotUnderstood", "verify open.nc part.nc", 2, "failure", "old program"},
    {"VerifyNotProved", "verify part.nc other.nc", 3, "verify", ""},
    {"VerifyNewNotUnderstood", "verify part.nc open.nc", 3, "failure", "NOT PROVED"},
    {"VerifyNoFile", "verify part.nc none.nc", 4, "failure", "none.nc"},
    {"Inspect", "inspect part.nc", 0, "inspect", ""},
    {"InspectUsage", "inspect part.nc --no-such", 1, "failure", "--no-such"},
    {"InspectNotUnderstood", "inspect open.nc", 2, "inspect", "--units"},
    {"InspectNoProgram", "inspect a.out", 2, "failure", "not-a-program"},
    {"InspectNoFile", "inspect none.nc", 4, "failure", "none.nc"},
    {"Time", "time part.nc --machine router", 0, "time", ""},
    {"TimeUsage", "time part.nc", 1, "failure", "--machine"},
    {"TimeNotUnderstood", "time a.out --machine router", 2, "failure", "not-a-program"},
    {"TimeNoFile", "time none.nc --machine router", 4, "failure", "none.nc"},
    {"Batch", "batch tree out -t grbl", 0, "batch", ""},
    {"BatchUsage", "batch tree out -t nothing", 1, "failure", "there is no 'nothing'"},
    {"BatchNotUnderstood", "batch bad out -t grbl", 2, "batch", "--units"},
    {"BatchNoPlace", "batch tree part.nc/out -t grbl", 4, "failure", "part.nc/out"},
    {"Setup", "setup -t grbl -o kept.toml", 0, "setup", "kept.toml"},
    {"SetupUsage", "setup -t nothing -o kept.toml", 1, "failure", "there is no 'nothing'"},
    {"SetupExists", "setup -t grbl -o part.nc", 4, "failure", "--force"},
    {"Freecad", "freecad install --folder tree", 0, "freecad", ""},
    {"FreecadUsage", "freecad", 1, "failure", "install"},
    {"FreecadNoFolder", "freecad install --folder none", 4, "failure", "none"},
    {"Targets", "targets", 0, "targets", ""},
    {"Target", "targets --show grbl", 0, "target", ""},
    {"TargetsUsage", "targets --show nothing", 1, "failure", "there is no 'nothing'"},
    {"Machines", "machines", 0, "machines", ""},
    {"Machine", "machines --show router", 0, "machine", ""},
    {"MachinesUsage", "machines --show nothing", 1, "failure", "nothing"},
    {"Methods", "methods", 0, "methods", ""},
    {"MethodsUsage", "methods more", 1, "failure", "more"},
    {"MethodTable", "methods --table corner.json", 0, "method-table", ""},
    {"MethodTableFile", "methods --table part.nc", 2, "failure", "part.nc"},
    {"NoSuchCommand", "smoth part.nc", 1, "failure", "smooth"},
};

class JsonAnswer : public testing::TestWithParam<AnswerRow> {
 protected:
  JsonAnswer() {
    folder_.put("part.nc", wave_program());
    folder_.put("corner.json", R"({"corner": {"points": [[0, 0], [9, 0], [9, 9]]}})");
    folder_.put("other.nc", "G21 G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\nG1 X50 Y0 F2000\nG0 Z5\nM2\n");
    folder_.put("open.nc", "G90 G17\nG0 X0 Y0 Z5\nG1 Z-1 F300\nX1\nX2 Y1\nX3\nM2\n");
    folder_.put("a.out", std::string("\x7f"
                                     "ELF\2\1\1\0\0",
                                     9));
    folder_.put("tree/part.nc", wave_program());
    folder_.put("bad/open.nc", folder_.text_of("open.nc"));
    std::filesystem::create_symlink("/dev/full", folder_.file("full.html"));
  }

  BattenFolder folder_;
};

TEST_P(JsonAnswer, IsOneObjectThatSaysHowItEnded) {
  const AnswerRow& row = GetParam();
  const ProcessResult done = folder_.batten(std::string(row.arguments) + " --json - </dev/null");
  EXPECT_EQ(done.exit_code, row.code) << done.err;
  const nlohmann::json json = nlohmann::json::parse(done.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << done.out << done.err;
  EXPECT_EQ(json["schema"], "batten-report/1");
  EXPECT_EQ(json["kind"], row.kind);
  EXPECT_EQ(json["exit_code"], row.code);
  ASSERT_TRUE(json["messages"].is_array());
  const nlohmann::json told = {json["messages"], json.value("diagnostics", nlohmann::json())};
  EXPECT_TRUE(contains(told.dump(), row.says)) << done.out;
  if (row.kind != std::string("failure")) return;
  EXPECT_FALSE(told[0].empty() && told[1].empty());
  EXPECT_FALSE(json["advice"].get<std::string>().empty());
}

INSTANTIATE_TEST_SUITE_P(Cli, JsonAnswer, testing::ValuesIn(kAnswers),
                         [](const auto& test) { return std::string(test.param.name); });

TEST_F(JsonAnswer, OfAFileIsWrittenWithTheExitCode) {
  expect_exit(folder_.batten("smooth open.nc -t grbl --json a.json"), 2);
  const nlohmann::json json = nlohmann::json::parse(folder_.text_of("a.json"));
  EXPECT_EQ(json["exit_code"], 2);
  EXPECT_EQ(json["understood"], false);
  ASSERT_FALSE(json["messages"].empty());
  EXPECT_TRUE(contains(json["messages"].back(), "not understood"));
}

TEST_F(JsonAnswer, IsNoneInAFileWhereTheCommandHasNoReport) {
  expect_exit(folder_.batten("smooth none.nc -t grbl --json a.json"), 4);
  expect_exit(folder_.batten("smooth part.nc --json a.json --tolerance x"), 1);
  EXPECT_FALSE(folder_.has("a.json"));
}

TEST_F(JsonAnswer, OfABatchIsTheOneInItsTree) {
  nlohmann::json json =
      nlohmann::json::parse(folder_.batten("batch tree out -t grbl --json -").out);
  nlohmann::json kept = nlohmann::json::parse(folder_.text_of("out/batten-batch/summary.json"));
  EXPECT_EQ(json, kept);
  kept = nlohmann::json::parse(folder_.text_of("out/batten-batch/reports/part.nc.json"));
  EXPECT_EQ(kept["kind"], "smooth");
  EXPECT_EQ(kept["exit_code"], 0);
}

// A pipe that nobody writes to.
TEST_F(JsonAnswer, TellsOfAnInterrupt) {
  const ProcessResult done =
      folder_.shell("mkfifo pipe; '" BATTEN_BINARY
                    "' smooth pipe -t grbl --json - & sleep 0.3; kill -TERM $!; wait $!");
  EXPECT_EQ(done.exit_code, 143);
  const nlohmann::json json = nlohmann::json::parse(done.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << done.out << done.err;
  EXPECT_EQ(json["exit_code"], 143);
  EXPECT_TRUE(contains(json["messages"].dump(), "interrupted"));
}

TEST_F(JsonAnswer, ThatCannotBeWrittenIsAFileError) {
  EXPECT_EQ(folder_.shell("batten methods --json - >/dev/full").exit_code, 4);
  EXPECT_EQ(folder_.shell("batten smooth --json - >/dev/full").exit_code, 1);
}

}  // namespace
}  // namespace batten
