// Programs of many megabytes, from files and streams: written window by window, and the same bytes,
// messages and reports as where the whole is asked for (`--report` needs it).
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>

#include "batten_process.h"
#include "tests/postproc/wavy_programs.h"

namespace batten {
namespace {

constexpr const char* kSmooth = "smooth part.nc --target linuxcnc --method fair --progress off ";

// A pass that is rewritten.
std::string pass() {
  return "G0 X0 Y0 Z5\nG1 Z-1 F300\n" +
         postproc::joined(postproc::wave_lines({.lines = 80}), "\n") + "G0 Z5\n";
}

// Two passes, nine megabytes of comments apart: read as fast as bytes, and above the size from
// which programs are smoothed in windows.
std::string long_program(const std::string& end = "M30\n") {
  const std::string line = "(" + std::string(998, 'x') + ")\n";
  std::string text = "G21 G90 G17\nM3 S9000\n" + pass() + "M9\n";
  for (int i = 0; i < 9000; ++i) text += line;
  for (int i = 0; i < 40000; ++i) text += "M8\nG0 Z5\n";
  return text + pass() + end;
}

class LongProgram : public testing::Test {
 protected:
  void SetUp() override { folder_.put("part.nc", long_program()); }

  // The bytes as the whole gives them.
  [[nodiscard]] std::string whole() const {
    const ProcessResult done =
        folder_.batten(std::string(kSmooth) + "-o whole.nc --report page.html --json whole.json");
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return folder_.text_of("whole.nc");
  }

  BattenFolder folder_;
};

TEST_F(LongProgram, GivesTheBytesAndTheReportOfTheWhole) {
  const std::string expected = whole();
  EXPECT_NE(expected, folder_.text_of("part.nc"));
  const ProcessResult done = folder_.batten(std::string(kSmooth) + "-o new.nc --json new.json");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(folder_.text_of("new.nc") == expected);
  std::string report = folder_.text_of("new.json");
  const std::size_t name = report.find("new.nc");
  ASSERT_NE(name, std::string::npos);
  report.replace(name, 6, "whole.nc");
  EXPECT_EQ(report, folder_.text_of("whole.json"));
}

TEST_F(LongProgram, GoesFromStandardInputToStandardOutput) {
  const std::string expected = whole();
  const ProcessResult done = folder_.shell(
      "cat part.nc | batten smooth - --target linuxcnc --method fair --progress off > new.nc");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(folder_.text_of("new.nc") == expected);
}

TEST_F(LongProgram, IsReplacedInPlace) {
  const std::string expected = whole();
  const ProcessResult done = folder_.batten(std::string(kSmooth) + "--in-place");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(folder_.text_of("part.nc") == expected);
}

TEST_F(LongProgram, IsNotWrittenInADryRunNorOverAnExistingFile) {
  const ProcessResult dry = folder_.batten(std::string(kSmooth) + "-o new.nc --dry-run");
  EXPECT_EQ(dry.exit_code, 0) << dry.err;
  EXPECT_FALSE(folder_.has("new.nc"));
  folder_.put("new.nc", "old\n");
  EXPECT_EQ(folder_.batten(std::string(kSmooth) + "-o new.nc").exit_code, 4);
  EXPECT_EQ(folder_.text_of("new.nc"), "old\n");
}

// What needs the whole may stand at the very end.
TEST_F(LongProgram, ThatNeedsTheWholeIsWrittenOnce) {
  folder_.put("part.nc", long_program("M99\n"));
  const std::string expected = whole();
  const ProcessResult done = folder_.batten(std::string(kSmooth) + "-o new.nc");
  EXPECT_EQ(done.exit_code, 0) << done.err;
  EXPECT_TRUE(folder_.text_of("new.nc") == expected);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.file("."))) {
    EXPECT_EQ(entry.path().filename().string().find("batten-part"), std::string::npos);
  }
}

TEST_F(LongProgram, ThatDoesNotFitOnTheDiskLeavesNothing) {
  const ProcessResult done =
      folder_.shell("ulimit -f 1024; batten smooth part.nc -o new.nc --target linuxcnc");
  EXPECT_EQ(done.exit_code, 4) << done.err;
  EXPECT_NE(done.err.find("new.nc"), std::string::npos) << done.err;
  EXPECT_FALSE(folder_.has("new.nc"));
}

// Rows of two hundred blocks between rapids.
std::string relief(std::size_t rows) {
  std::string row = "G0 X0 Y0 Z5\nG1 Z-1 F300\n";
  for (int i = 1; i <= 200; ++i) {
    row += "G1 X" + std::to_string(i) + ".125 Y" + std::to_string(i % 7) + ".250 F900\n";
  }
  std::string text = "G21 G90 G17\nM3 S9000\n";
  for (std::size_t i = 0; i < rows; ++i) text += row + "G0 Z5\n";
  return text + "M30\n";
}

// Runs what follows and prints the most bytes of memory that it took. This process is no measure: a
// child counts what its parent had when it was made.
constexpr const char* kMeasured =
    "python3 -c 'import resource, subprocess, sys\n"
    "code = subprocess.call(sys.argv[1:])\n"
    "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)\n"
    "sys.exit(code)' '" BATTEN_BINARY "' ";

// Twice the blocks, and no more memory than some bytes of each, for the report of its run: held as
// a whole a block takes some hundred.
TEST(MemoryOfLongPrograms, DoesNotGrowWithTheirBlocks) {
  constexpr std::size_t kRows = 2000;
  constexpr std::size_t kBytesOfBlock = 10;
  const BattenFolder folder;
  const auto memory_of = [&](std::size_t rows) {
    folder.put("part.nc", relief(rows));
    // What a sanitizer would keep of memory that was given back is no memory of the program.
    const ProcessResult done = folder.shell(
        std::string("export ASAN_OPTIONS=quarantine_size_mb=1:$ASAN_OPTIONS; ") + kMeasured +
        "smooth part.nc -o new.nc --force --target linuxcnc --method none --threads 1 --quiet");
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return std::stoul(done.out);
  };
  const std::size_t once = memory_of(kRows);
  const std::size_t twice = memory_of(2 * kRows);
  EXPECT_LE(twice, once + kRows * 200 * kBytesOfBlock);
}

// The same of `inspect`, which keeps what it says of each row: two sections.
TEST(MemoryOfLongPrograms, DoesNotGrowWithTheBlocksThatAreInspected) {
  constexpr std::size_t kRows = 2000;
  constexpr std::size_t kBytesOfBlock = 10;
  const BattenFolder folder;
  const auto memory_of = [&](std::size_t rows) {
    folder.put("part.nc", relief(rows));
    const ProcessResult done =
        folder.shell(std::string("export ASAN_OPTIONS=quarantine_size_mb=1:$ASAN_OPTIONS; ") +
                     kMeasured + "inspect part.nc | tail -1");
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return std::stoul(done.out);
  };
  const std::size_t text = relief(kRows).size();  // that is mapped
  const std::size_t once = memory_of(kRows);
  EXPECT_LE(memory_of(2 * kRows), once + text + kRows * 200 * kBytesOfBlock);
}

// The same of `verify`, which holds parts of two programs.
TEST(MemoryOfLongPrograms, DoesNotGrowWithTheBlocksThatAreVerified) {
  constexpr std::size_t kRows = 2000;
  constexpr std::size_t kBytesOfBlock = 10;
  const BattenFolder folder;
  const auto memory_of = [&](std::size_t rows) {
    folder.put("old.nc", relief(rows));
    folder.put("new.nc", relief(rows) + "(the end)\n");
    const ProcessResult done =
        folder.shell(std::string("export ASAN_OPTIONS=quarantine_size_mb=1:$ASAN_OPTIONS; ") +
                     kMeasured + "verify old.nc new.nc");
    EXPECT_EQ(done.exit_code, 0) << done.err;
    return std::stoul(done.out);
  };
  const std::size_t texts = 2 * relief(kRows).size();  // that are mapped
  const std::size_t once = memory_of(kRows);
  EXPECT_LE(memory_of(2 * kRows), once + texts + kRows * 200 * kBytesOfBlock);
}

// What differs is said by line and place, wherever it stands.
TEST(VerifyOfLongPrograms, TellsWhatDiffersAtEitherEnd) {
  const BattenFolder folder;
  const std::string before = relief(2000);
  folder.put("old.nc", before);
  const auto told_of = [&](const std::string& after) {
    folder.put("new.nc", after);
    const ProcessResult done = folder.batten("verify old.nc new.nc");
    EXPECT_EQ(done.exit_code, 3) << done.err;
    return done.err;
  };
  std::string moved = before;
  moved.replace(moved.rfind("X100.125"), 8, "X100.925");
  const std::size_t line = 3 + 203 * 1999 + 101;
  EXPECT_NE(told_of(moved).find("new.nc:" + std::to_string(line) + ": distance"),
            std::string::npos);
  std::string early = before;
  early.insert(early.find("G0 X0"), "M8\n");
  EXPECT_NE(told_of(early).find("new.nc:3: event-added: M8"), std::string::npos);
}

}  // namespace
}  // namespace batten
