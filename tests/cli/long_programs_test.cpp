// Programs of many megabytes, from files and streams: written window by window, and the same bytes,
// messages and reports as where the whole is asked for (`--report` needs it).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "batten_process.h"
#include "tests/support/counts_memory.h"
#include "tests/support/places.h"
#include "tests/support/wavy_programs.h"

namespace batten {
namespace {

constexpr const char* kSmoothLong =
    "smooth part.nc --target linuxcnc --method fair --progress off ";

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
    expect_exit(folder_.batten(std::string(kSmoothLong) +
                               "-o whole.nc --report page.html --json whole.json"),
                0);
    return folder_.text_of("whole.nc");
  }

  BattenFolder folder_;
};

TEST_F(LongProgram, GivesTheBytesAndTheReportOfTheWhole) {
  const std::string expected = whole();
  EXPECT_NE(expected, folder_.text_of("part.nc"));
  expect_exit(folder_.batten(std::string(kSmoothLong) + "-o new.nc --json new.json"), 0);
  EXPECT_TRUE(folder_.text_of("new.nc") == expected);
  std::string report = folder_.text_of("new.json");
  const std::size_t name = report.find("new.nc");
  ASSERT_NE(name, std::string::npos);
  report.replace(name, 6, "whole.nc");
  EXPECT_EQ(report, folder_.text_of("whole.json"));
}

TEST_F(LongProgram, GoesFromStandardInputToStandardOutput) {
  const std::string expected = whole();
  expect_exit(
      folder_.shell(
          "cat part.nc | batten smooth - --target linuxcnc --method fair --progress off > new.nc"),
      0);
  EXPECT_TRUE(folder_.text_of("new.nc") == expected);
}

TEST_F(LongProgram, IsReplacedInPlace) {
  const std::string expected = whole();
  expect_exit(folder_.batten(std::string(kSmoothLong) + "--in-place"), 0);
  EXPECT_TRUE(folder_.text_of("part.nc") == expected);
}

TEST_F(LongProgram, IsNotWrittenInADryRunNorOverAnExistingFile) {
  expect_exit(folder_.batten(std::string(kSmoothLong) + "-o new.nc --dry-run"), 0);
  EXPECT_FALSE(folder_.has("new.nc"));
  folder_.put("new.nc", "old\n");
  EXPECT_EQ(folder_.batten(std::string(kSmoothLong) + "-o new.nc").exit_code, 4);
  EXPECT_EQ(folder_.text_of("new.nc"), "old\n");
}

// What needs the whole may stand at the very end.
TEST_F(LongProgram, ThatNeedsTheWholeIsWrittenOnce) {
  folder_.put("part.nc", long_program("M99\n"));
  const std::string expected = whole();
  expect_exit(folder_.batten(std::string(kSmoothLong) + "-o new.nc"), 0);
  EXPECT_TRUE(folder_.text_of("new.nc") == expected);
  for (const auto& entry : std::filesystem::directory_iterator(folder_.file("."))) {
    EXPECT_EQ(entry.path().filename().string().find("batten-part"), std::string::npos);
  }
}

// More threads than there are cores: no more work at once, and no word of it.
TEST_F(LongProgram, IsSmoothedUnderAnyNumberOfThreadsWithoutAWord) {
  for (const char* threads : {"1", "200"}) {
    const ProcessResult done =
        expect_exit(folder_.batten(std::string(kSmoothLong) + "--quiet --force -o " + threads +
                                   ".nc --threads " + threads),
                    0);
    EXPECT_EQ(done.err, "");
  }
  EXPECT_EQ(folder_.text_of("1.nc"), folder_.text_of("200.nc"));
}

TEST_F(LongProgram, ThatDoesNotFitOnTheDiskLeavesNothing) {
  const ProcessResult done = expect_exit(
      folder_.shell("ulimit -f 1024; batten smooth part.nc -o new.nc --target linuxcnc"), 4);
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

// The most bytes of memory that a command of the program takes. This process is no measure: a child
// counts what its parent had when it was made. What a sanitizer would keep of memory that was given
// back is no memory of the program.
std::size_t memory_of(const BattenFolder& folder, const std::string& command) {
  constexpr const char* kMeasured =
      "export ASAN_OPTIONS=quarantine_size_mb=1:$ASAN_OPTIONS; "
      "python3 -c 'import resource, subprocess, sys\n"
      "code = subprocess.call(sys.argv[1:], stdout=subprocess.DEVNULL)\n"
      "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)\n"
      "sys.exit(code)' '" BATTEN_BINARY "' ";
  return std::stoul(expect_exit(folder.shell(kMeasured + command), 0).out);
}

// A helix of arcs of 20 degrees, some hundred chords each when they are compared. `moved`: each but
// every tenth ends half a degree earlier.
std::string helix(int arcs, bool moved) {
  constexpr double kDegree = 3.14159265358979 / 180;
  std::string text = "G21 G17 G90 G94\nG0 X50 Y0 Z0\nG1 F1000\n";
  std::pair<double, double> from(50, 0);
  for (int i = 1; i <= arcs; ++i) {
    const double angle = 20 * i - (moved && i % 10 != 0 ? 0.5 : 0);
    const double x = 50 * std::cos(angle * kDegree);
    const double y = 50 * std::sin(angle * kDegree);
    text += fmt::format("G3 X{:.4f} Y{:.4f} Z{:.4f} I{:.4f} J{:.4f}\n", x, y, 0.01 * angle,
                        -from.first, -from.second);
    from = {std::round(x * 1e4) / 1e4, std::round(y * 1e4) / 1e4};
  }
  return text + "G0 Z999\nM2\n";
}

// Between positions that both paths pass arcs are compared by themselves: the chords of all of them
// would take 19 kB for each.
TEST(MemoryOfLongPrograms, IsNotThatOfTheChordsOfTheirArcs) {
  constexpr std::size_t kMost = 4000;  // for each arc
  const BattenFolder folder;
  std::size_t memory[2] = {};
  for (const int k : {0, 1}) {
    const int arcs = k == 0 ? 1000 : 3000;
    folder.put("old.nc", helix(arcs, false));
    folder.put("new.nc", helix(arcs, true));
    memory[k] = memory_of(folder, "verify old.nc new.nc --tolerance 0.01");
  }
  EXPECT_LE(memory[1], memory[0] + 2000 * kMost);
}

// Rows of two hundred blocks, and half as many more: no more memory than some bytes of each block,
// for the report of its run. Of fewer rows how a heap lies is more than that. Held as a whole a
// block takes some hundred.
constexpr std::size_t kRows = 1000;
constexpr std::size_t kForReport = kRows * 200 * 10;

// What is mapped counts as memory, too, of `verify` for two programs; `inspect` keeps two sections
// of each row.
TEST(MemoryOfLongPrograms, DoesNotGrowWithTheirBlocks) {
  const BattenFolder folder;
  const std::string text = relief(kRows);
  for (const auto& [name, rows] : {std::pair{"once", 2 * kRows}, {"more", 3 * kRows}}) {
    folder.put(fmt::format("{}.nc", name), relief(rows));
    folder.put(fmt::format("{}.new.nc", name), relief(rows) + "(the end)\n");
  }
  struct Row {
    const char* command;
    std::size_t mapped;
  };
  for (const auto& [command, mapped] :
       {Row{"smooth {0}.nc -o new.nc --force --target linuxcnc --method none --threads 1", 0},
        Row{"inspect {0}.nc", text.size()}, Row{"verify {0}.nc {0}.new.nc", 2 * text.size()}}) {
    const std::size_t once = memory_of(folder, fmt::format(fmt::runtime(command), "once"));
    const std::size_t more = memory_of(folder, fmt::format(fmt::runtime(command), "more"));
    EXPECT_LE(more, once + mapped + kForReport) << command;
  }
}

// A run of so many short lines along a wave, of which few remain.
std::string one_run(int lines) {
  std::string text = "G21 G90 G17\nM3 S9000\nG0 X0 Y0 Z5\nG1 Z-1 F300\nF2000\n";
  for (int i = 1; i <= lines; ++i) {
    text += fmt::format("G1 X{:.4f} Y{:.4f}\n", 0.1 * i, 20 * std::sin(0.002 * i));
  }
  return text + "G0 Z5\nM30\n";
}

// Of one run that is rewritten a block more takes some bytes; how a heap happens to lie is most of
// them. Held as a whole it takes some thousand.
TEST(MemoryOfLongPrograms, GrowsBySomeBytesForABlockOfOneLongRun) {
  if (!kCountsMemory) GTEST_SKIP() << "a sanitizer takes more";
  constexpr int kLines = 150'000;
  const BattenFolder folder;
  const auto memory_with = [&](int lines) {
    const std::string text = one_run(lines);
    folder.put("part.nc", text);
    const std::string options = " -o new.nc --force --target linuxcnc --method fair --threads 1";
    const std::size_t memory = memory_of(folder, "smooth part.nc" + options);
    EXPECT_LT(folder.text_of("new.nc").size(), text.size() / 4) << "it is rewritten";
    return memory;
  };
  EXPECT_LE(memory_with(2 * kLines), memory_with(kLines) + std::size_t{kLines} * 40);
}

// What differs is said by line and place, wherever it stands.
TEST(VerifyOfLongPrograms, TellsWhatDiffersAtEitherEnd) {
  const BattenFolder folder;
  const std::string before = relief(2000);
  folder.put("old.nc", before);
  const auto told_of = [&](const std::string& after) {
    folder.put("new.nc", after);
    return expect_exit(folder.batten("verify old.nc new.nc"), 3).err;
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
