// What is wrong is told at once, by one line, and nothing is written.

#include <gtest/gtest.h>

#include <algorithm>

#include "batten_process.h"
#include "tests/support/places.h"

namespace batten {
namespace {

class FailingWell : public testing::Test {
 protected:
  void SetUp() override { folder_.put("part.nc", wave_program()); }

  void expect_refusal(const std::string& arguments, int code, const std::string& message) const {
    const ProcessResult done = expect_exit(folder_.batten(arguments), code, {message});
    EXPECT_FALSE(contains(done.err, "proved:")) << done.err;
    EXPECT_FALSE(folder_.has("part.smooth.nc"));
  }

  BattenFolder folder_;
};

TEST_F(FailingWell, FilesThatAreNoProgramsAreRefusedByEveryCommand) {
  folder_.put("a.out", std::string("\x7f"
                                   "ELF\2\1\1\0\0",
                                   9));
  for (const char* command :
       {"smooth a.out -t grbl", "smooth a.out -t heidenhain", "smooth a.out -t siemens --convert",
        "smooth a.out -t grbl --dry-run", "inspect a.out", "verify a.out part.nc",
        "verify a.out a.out", "time a.out --machine router"}) {
    expect_refusal(command, 2, "a.out:1:1: error: not-a-program");
  }
  EXPECT_FALSE(folder_.has("a.smooth.out"));
}

TEST_F(FailingWell, PlacesThatCannotBeWrittenAreFoundBeforeTheWork) {
  folder_.put("file", "");
  for (const char* option : {"-o", "--json", "--report"}) {
    const std::string page = option == std::string("--report") ? "/x.html" : "/x";
    const std::string start = std::string("smooth part.nc -t grbl ") + option + " ";
    expect_refusal(start + "none" + page, 4, "none: No such file or directory");
    expect_refusal(start + "file" + page, 4, "file is no folder");
  }
  expect_refusal("smooth part.nc -t grbl -o .", 4, "it is a folder");
}

TEST_F(FailingWell, CommandsThatOnlyReadFindPlacesOfReportsBeforeTheWork) {
  folder_.put("old.json", "{}");
  folder_.put("file", "");
  for (const char* command :
       {"inspect part.nc", "verify part.nc part.nc", "explore part.nc -t grbl",
        "time part.nc --machine router", "time part.nc --machine router --json - --profile"}) {
    const bool profile = std::string(command).ends_with("--profile");
    const std::string start = std::string(command) + (profile ? " " : " --json ");
    for (const auto& [place, why] :
         {std::pair("none/x", "none: No such file"), std::pair("file/x", "file is no folder"),
          std::pair(".", "it is a folder"), std::pair("old.json", "exists already")}) {
      const ProcessResult done = expect_exit(folder_.batten(start + place), 4, {why});
      EXPECT_EQ(std::ranges::count(done.err, '\n'), 1) << done.err;
    }
  }
}

TEST_F(FailingWell, VerifyWithAFileThatIsNoProgramSaysThatAlone) {
  folder_.put("a.out", std::string("\x7f"
                                   "ELF\2\1\1\0\0",
                                   9) +
                           "\n)\n(\nG1.25\n\1\2\n)\n");
  const ProcessResult done =
      expect_exit(folder_.batten("verify a.out part.nc"), 2, {"a.out:1:1: error: not-a-program"});
  EXPECT_EQ(std::ranges::count(done.err, '\n'), 2) << done.err;
}

TEST_F(FailingWell, TheFolderOfALinkIsTheOneItLeadsTo) {
  folder_.put("far/new.nc", "");
  EXPECT_EQ(folder_.shell("mkdir near; ln -s ../far/new.nc near/link").exit_code, 0);
  expect_exit(folder_.batten("smooth part.nc -t linuxcnc -o near/link --force"), 0);
  EXPECT_NE(folder_.text_of("far/new.nc"), "");
}

TEST_F(FailingWell, AReportIsAPage) {
  expect_refusal("smooth part.nc -t grbl --report x.pdf", 1, "x.pdf: a page is written");
}

TEST_F(FailingWell, SettingsOfAWrongFileGiveOneError) {
  folder_.put("other.txt", "one\ntwo\nthree\n");
  folder_.put("a.out", std::string("\x7f"
                                   "ELF\2\1\1\0\0",
                                   9));
  const std::string start = "smooth part.nc -t grbl --grbl-settings ";
  expect_refusal(start + "other.txt", 1, "'one', expected a setting such as $110=5000.000; 2 more");
  expect_refusal(start + "a.out", 1, "is a program for computers");
}

// The wave is 24 mm long, in 120 steps of 0.22 mm.
TEST_F(FailingWell, ATooLargeToleranceIsToldBeforeTheRest) {
  const auto told = [&](const char* options) {
    return folder_.batten(std::string("smooth part.nc -t linuxcnc --dry-run --json - ") + options);
  };
  const ProcessResult small = told("--tolerance 0.05");
  EXPECT_FALSE(contains(small.out + small.err, "tolerance-")) << small.err;
  const ProcessResult large = expect_exit(
      told("--tolerance 0.25"), 0,
      {"part.nc:4:1: warning: tolerance-large: the tolerance of 0.25 mm",
       "warning: tolerance-above-chords: 120 of the 120 moves in runs are shorter than"});
  EXPECT_TRUE(contains(large.out, "\"tolerance-large\"")) << large.out;
  EXPECT_FALSE(contains(told("--tolerance 0.25 --method none").err, "tolerance-"));
}

TEST_F(FailingWell, ABatchOfNothingSaysSo) {
  folder_.put("docs/readme.txt", "G21\n");
  expect_exit(folder_.batten("batch docs out -t grbl"), 0, {"no programs in it", "--suffix"});
}

TEST_F(FailingWell, ShortFormsAreWhatTheyStandFor) {
  EXPECT_EQ(folder_.batten("-V").out, folder_.batten("--version").out);
  EXPECT_EQ(folder_.batten("help smooth").out, folder_.batten("smooth --help").out);
  EXPECT_EQ(folder_.batten("help").out, folder_.batten("--help").out);
  expect_exit(folder_.batten("smooth part.nc -t linuxcnc"), 0);
}

}  // namespace
}  // namespace batten
