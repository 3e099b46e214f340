// Signals at random moments: whoever ends the program, and when, the files are the old ones or the
// new ones, and what is not SIGKILL is told and leaves nothing behind. Part of the list in
// docs/faults.md.
//
// BATTEN_SIGNALS=200 cli_tests --gtest_filter='Signals.*' sends more of them.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "batten_process.h"
#include "tests/support/wavy_programs.h"

namespace batten {
namespace {

namespace fs = std::filesystem;

// Signals that are sent when nobody asks for more.
constexpr int kSignals = 20;

int signals_to_send() {
  const char* given = std::getenv("BATTEN_SIGNALS");
  return given == nullptr ? kSignals : std::atoi(given);
}

// Some thousand lines that are rewritten: long enough to be caught at work.
std::string program_of_lines(int lines) { return postproc::wave_program({.lines = lines}); }

struct Counts {
  int done = 0;
  int told = 0;
  int killed = 0;
};

class Signals : public testing::Test {
 protected:
  void SetUp() override {
    folder_.put("part.nc", old_);
    ASSERT_EQ(folder_.shell("batten smooth part.nc --target linuxcnc -o whole.nc").exit_code, 0);
    new_ = folder_.text_of("whole.nc");
    ASSERT_TRUE(new_ != old_);
  }

  // One run that is sent `signal_number`, and at once again where `twice`, after so many
  // microseconds.
  void disturb(bool in_place, int signal_number, bool twice, unsigned after) {
    folder_.put("part.nc", old_);
    std::vector<std::string> arguments = {"smooth", "part.nc", "--target", "linuxcnc"};
    if (in_place) {
      arguments.emplace_back("--in-place");
    } else {
      arguments.insert(arguments.end(), {"-o", "new.nc", "--force"});
    }
    const Started started(folder_, arguments);
    ::usleep(after);
    started.send(signal_number);
    if (twice) started.send(signal_number);
    check(started.wait(), in_place, signal_number);
  }

  void check(int status, bool in_place, int signal_number) {
    const bool done = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    const bool told = WIFEXITED(status) && WEXITSTATUS(status) == 128 + signal_number;
    // Killed by the signal itself: SIGKILL, or any before the program has its first word.
    const bool killed = WIFSIGNALED(status) && WTERMSIG(status) == signal_number;
    EXPECT_TRUE(done || told || killed) << "status " << status << "\n" << folder_.text_of("err");
    counts_.done += done ? 1 : 0;
    counts_.told += told ? 1 : 0;
    counts_.killed += killed ? 1 : 0;

    const std::string part = folder_.text_of("part.nc");
    if (in_place) {
      EXPECT_TRUE(part == old_ || part == new_) << part.size() << " bytes";
      EXPECT_TRUE(!done || part == new_);
    } else {
      EXPECT_TRUE(part == old_) << part.size() << " bytes";
      EXPECT_TRUE(folder_.has("new.nc") || !done);
      EXPECT_TRUE(!folder_.has("new.nc") || folder_.text_of("new.nc") == new_);
      fs::remove(folder_.file("new.nc"));
    }
    const auto left = half_written_in(folder_.file("."));
    EXPECT_TRUE(signal_number == SIGKILL || left.empty());
    for (const fs::path& file : left) fs::remove(file);
  }

  BattenFolder folder_;
  std::string old_ = program_of_lines(1000);
  std::string new_;
  Counts counts_;
};

// The moments reach from the start to a little beyond the end: where a run was done before its
// signal came, later ones get theirs earlier, and the other way round.
TEST_F(Signals, AtRandomMomentsLeaveTheOldOrTheNewBytes) {
  constexpr int kKinds[] = {SIGTERM, SIGKILL, SIGINT, SIGKILL, SIGHUP};
  std::mt19937 random(7);
  double longest = 100'000;  // microseconds
  const int signals = signals_to_send();
  for (int i = 0; i < signals; ++i) {
    const int kind = kKinds[i % 5];
    const bool twice = i % 10 == 0;
    SCOPED_TRACE(testing::Message() << "signal " << i << ", " << kind << (twice ? " twice" : ""));
    const int done_before = counts_.done;
    disturb(i % 2 == 0, kind, twice,
            static_cast<unsigned>(longest * (static_cast<double>(random() % 1000) / 1000)));
    longest *= counts_.done > done_before ? 0.75 : 1.3;
    if (HasFailure()) break;
  }
  std::printf("%d signals: %d runs were done before, %d told, %d killed\n", signals, counts_.done,
              counts_.told, counts_.killed);
  EXPECT_GT(counts_.told, 0);
  EXPECT_GT(counts_.killed, 0);
}

// To and fro for 40,000 lines: a run whose search takes long.
std::string one_long_search() {
  std::string text = "G21 G17 G90 G94\nG0 X0 Y0 Z5\nG1 Z0 F1000\n";
  for (int i = 1; i <= 40'000; ++i) {
    text += "G1 X" + std::to_string(i / 2) + (i % 2 == 0 ? ".0" : ".5") + " Y" +
            std::to_string(3 * (i % 2)) + "\n";
  }
  return text + "G0 Z5\nM2\n";
}

// It is over when that search is, or when it is ended there.
TEST(SignalsInOneSearch, AreHeededWithinAboutASecond) {
  const BattenFolder folder;
  folder.put("part.nc", one_long_search());
  const Started started(folder, {"smooth", "part.nc", "--target", "linuxcnc", "--method", "naseath",
                                 "--threads", "1", "-o", "new.nc"});
  ::usleep(1'500'000);
  started.send(SIGTERM);
  const int status = started.wait();
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 143) << status;
  EXPECT_NE(folder.text_of("err").find("interrupted in the midst"), std::string::npos)
      << folder.text_of("err");
  EXPECT_FALSE(folder.has("new.nc"));
  EXPECT_TRUE(half_written_in(folder.file(".")).empty());
}

// A program that waits for a pipe, on either side, is not at work, and a signal ends it all the
// same.
struct Waiting {
  const char* name;
  std::vector<std::string> arguments;
};

class WaitingProgram : public testing::TestWithParam<Waiting> {};

TEST_P(WaitingProgram, IsEndedByOneSignalAndSaysSo) {
  const BattenFolder folder;
  folder.put("part.nc", wave_program());
  ASSERT_EQ(::mkfifo(folder.file("pipe").c_str(), 0644), 0);
  const Started started(folder, GetParam().arguments);
  // Long enough to wait for the pipe; where the machine is slower, the signal comes before that,
  // and what is promised is the same.
  ::usleep(500'000);
  started.send(SIGTERM);
  const int status = started.wait();
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 143) << status;
  EXPECT_NE(folder.text_of("err").find("interrupted"), std::string::npos) << folder.text_of("err");
  EXPECT_EQ(folder.text_of("part.nc"), wave_program());
  EXPECT_FALSE(folder.has("new.nc"));
}

INSTANTIATE_TEST_SUITE_P(
    Cli, WaitingProgram,
    testing::Values(
        Waiting{"ForItsInput", {"smooth", "pipe", "--target", "linuxcnc", "-o", "new.nc"}},
        Waiting{"ForTheReaderOfItsOutput",
                {"smooth", "part.nc", "--target", "linuxcnc", "-o", "pipe"}},
        Waiting{"ForTheReaderOfItsReport",
                {"smooth", "part.nc", "--target", "linuxcnc", "--dry-run", "--json", "pipe"}},
        Waiting{"ForTheSecondProgram", {"verify", "part.nc", "pipe"}},
        Waiting{"ToInspect", {"inspect", "pipe"}}),
    [](const auto& test) { return std::string(test.param.name); });

// Written into, cut short or replaced while it is at work: nothing is written then, and whoever
// wrote into it loses nothing.
struct Change {
  const char* name;
  const char* lines;    // a script that changes part.nc
  const char* message;  // one of them
};

class ChangedInput : public testing::TestWithParam<Change> {};

TEST_P(ChangedInput, IsNotReplacedInPlace) {
  const std::string old = program_of_lines(3000);
  std::mt19937 random(3);
  int caught = 0;
  double longest = 400'000;  // microseconds
  for (int i = 0; i < 6; ++i) {
    SCOPED_TRACE(testing::Message() << "change " << i);
    const BattenFolder folder;
    folder.put("part.nc", old);
    ASSERT_EQ(folder.shell("touch -d 2001-01-01 part.nc").exit_code, 0);
    const Started started(folder, {"smooth", "part.nc", "--target", "linuxcnc", "--in-place"});
    ::usleep(static_cast<unsigned>(longest * (static_cast<double>(random() % 1000) / 1000)));
    started.send(SIGSTOP);
    const bool was_done = folder.text_of("part.nc") != old;
    ASSERT_EQ(folder.shell(GetParam().lines).exit_code, 0);
    const std::string theirs = folder.text_of("part.nc");
    started.send(SIGCONT);
    const int status = started.wait();
    longest *= was_done ? 0.6 : 1.2;
    if (was_done) continue;
    ASSERT_TRUE(WIFEXITED(status)) << status << folder.text_of("err");
    EXPECT_EQ(half_written_in(folder.file(".")).size(), 0u);
    const std::string part = folder.text_of("part.nc");
    if (WEXITSTATUS(status) == 0) {
      // Before the file was opened its new bytes are the program.
      folder.put("theirs.nc", theirs);
      ASSERT_EQ(folder.batten("smooth theirs.nc --target linuxcnc").exit_code, 0);
      EXPECT_TRUE(part == folder.text_of("theirs.smooth.nc"));
      continue;
    }
    EXPECT_TRUE(part == theirs);
    if (WEXITSTATUS(status) != 4) continue;  // or they are no program
    EXPECT_NE(folder.text_of("err").find(GetParam().message), std::string::npos);
    ++caught;
  }
  EXPECT_GT(caught, 0);
}

INSTANTIATE_TEST_SUITE_P(
    Cli, ChangedInput,
    testing::Values(
        // The bytes that were read last time keep their size, so only the time tells.
        Change{"WrittenInto", "printf '%s' '(M2)' | dd of=part.nc conv=notrunc 2>.dd",
               "part.nc: was changed while it was read"},
        Change{"CutShort", "printf 'M2\\n' >part.nc", "while it was read"},
        Change{"Replaced", "printf 'M2\\n' >x; mv x part.nc",
               "part.nc: was replaced or removed while it was read"}),
    [](const auto& test) { return std::string(test.param.name); });

}  // namespace
}  // namespace batten
