// `--report` and `--open` of the commands, as a user's shell sees them. What the page shows:
// tests/report_page/.

#include <gtest/gtest.h>

#include "batten_process.h"

namespace batten {
namespace {

constexpr const char* kPageProgram = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F600\nX20 Y0.001\nX30 Y0\nM2\n";

// Each command that has a page, on two programs of the folder.
constexpr const char* kCommands[] = {"smooth part.nc --target linuxcnc --dry-run --quiet",
                                     "verify part.nc same.nc --quiet", "inspect part.nc",
                                     "time part.nc --machine mill"};

class ReportPage : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    folder_.put("part.nc", kPageProgram);
    folder_.put("same.nc", "G21 G90\nG0 X0 Y0 Z0\nG1 X30 F600\nM2\n");
    // Stands for the browser: it writes down what it is to show.
    ASSERT_EQ(folder_
                  .shell("mkdir bin && printf '#!/bin/sh\\necho \"$1\" > shown\\n' > bin/xdg-open "
                         "&& chmod +x bin/xdg-open")
                  .exit_code,
              0);
  }

  [[nodiscard]] ProcessResult run(const std::string& options) const {
    return folder_.shell("PATH=\"$PWD/bin:$PATH\" batten " + std::string(GetParam()) + " " +
                         options);
  }

  BattenFolder folder_;
};

TEST_P(ReportPage, IsWrittenWhereItIsAskedFor) {
  EXPECT_EQ(run("--report page.html").exit_code, 0);
  const std::string page = folder_.text_of("page.html");
  EXPECT_TRUE(page.starts_with("<!doctype html>"));
  EXPECT_TRUE(contains(page, "--report page.html")) << "the command to make it again";
  EXPECT_FALSE(folder_.has("shown"));
}

TEST_P(ReportPage, IsShownByOpen) {
  EXPECT_EQ(run("--report page.html --open").exit_code, 0);
  EXPECT_EQ(folder_.text_of("shown"), "page.html\n");
}

TEST_P(ReportPage, OfOpenAloneIsATemporaryFile) {
  EXPECT_EQ(run("--open").exit_code, 0);
  std::string shown = folder_.text_of("shown");
  ASSERT_FALSE(shown.empty());
  shown.pop_back();
  EXPECT_TRUE(shown.ends_with(".nc.html")) << shown;
  EXPECT_EQ(folder_.shell("grep -c doctype '" + shown + "' && rm '" + shown + "'").exit_code, 0);
}

TEST_P(ReportPage, ThatCannotBeShownIsRefusedBeforeTheWork) {
  const ProcessResult result = folder_.shell("PATH=/nowhere batten " + std::string(GetParam()) +
                                             " --report page.html --open");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_TRUE(contains(result.err, "--open: there is no xdg-open here")) << result.err;
  EXPECT_FALSE(folder_.has("page.html"));
}

TEST_P(ReportPage, ThatTheBrowserRefusesIsWrittenAndTheFailureTold) {
  folder_.put("bin/xdg-open", "#!/bin/sh\nexit 3\n");
  const ProcessResult result = run("--report page.html --open");
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_TRUE(contains(result.err, "page.html: written, but not shown")) << result.err;
  EXPECT_TRUE(folder_.has("page.html"));
}

TEST_P(ReportPage, IsNoOtherFile) {
  EXPECT_EQ(run("--report page.pdf").exit_code, 1);
  EXPECT_EQ(run("--report part.nc").exit_code, 1);
  EXPECT_EQ(run("--report a.html --json a.html").exit_code, 1);
  EXPECT_EQ(run("--report - --open").exit_code, 1);
  EXPECT_EQ(folder_.text_of("part.nc"), kPageProgram);
}

TEST_P(ReportPage, ReplacesNothingWithoutForce) {
  folder_.put("page.html", "mine");
  EXPECT_EQ(run("--report page.html").exit_code, 4);
  EXPECT_EQ(folder_.text_of("page.html"), "mine");
}

INSTANTIATE_TEST_SUITE_P(Cli, ReportPage, testing::ValuesIn(kCommands),
                         [](const auto& each) -> std::string {
                           const std::string command = each.param;
                           return command.substr(0, command.find(' '));
                         });

}  // namespace
}  // namespace batten
