// Programs that are smoothed window by window come out as they do as a whole: the same bytes, the
// same report, the same messages.
#include "postproc/windows.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "postproc/program_scout.h"
#include "postproc/window_work.h"
#include "tests/postproc/in_windows.h"
#include "tests/postproc/wavy_programs.h"

namespace batten::postproc {
namespace {

// Returns how many windows there were, as many as `least_blocks` allow; 0 where the program needs
// the whole.
std::size_t compare_both_ways(const std::string& text, const SmoothOptions& options,
                              std::initializer_list<std::size_t> least_blocks) {
  std::size_t most = 0;
  std::optional<SmoothResult> whole;
  for (const std::size_t least : least_blocks) {
    SCOPED_TRACE(testing::Message() << "windows of " << least << " blocks and more");
    const InWindows windows = in_windows(text, options, least);
    if (!windows.result) return 0;
    if (!whole) whole = as_a_whole(text, options);
    expect_same(windows, *whole);
    most = std::max(most, windows.parts);
  }
  return most;
}

// --- programs that are put together from what programs are made of ------------------------------

class RandomPasses {
 public:
  explicit RandomPasses(unsigned seed) : random_(seed), line_end_(seed % 4 == 3 ? "\r\n" : "\n") {}

  std::string make() {
    const bool inches = chance(8);
    if (chance(2)) add("%");
    if (chance(2)) add("O1000 (PART)");
    add(inches ? "G20 G90 G17 G94" : "G21 G90 G17");
    add("T1 M6");
    add("S9000 M3");
    scale_ = inches ? 1 / 25.4 : 1;
    add(fmt::format("G0 X{} Y{} Z{}", number(0), number(0), number(5)));
    const int passes = 3 + pick(9);
    for (int i = 0; i < passes; ++i) pass();
    add("G0 Z" + number(20));
    add("M5");
    add("M30");
    if (text_.starts_with("%")) add("%");
    if (chance(4)) text_ += "(the end)";
    return text_;
  }

 private:
  int pick(int below) { return static_cast<int>(random_() % static_cast<unsigned>(below)); }
  bool chance(int one_in) { return pick(one_in) == 0; }
  void add(const std::string& line) { text_ += line + line_end_; }
  [[nodiscard]] std::string number(double mm) const { return fmt::format("{:.4f}", mm * scale_); }

  void pass() {
    between();
    const double x = pick(50);
    const double y = pick(50);
    add(fmt::format("G0 X{} Y{}", number(x), number(y)));
    if (chance(3)) add("G0 Z" + number(1));
    if (chance(4)) add(chance(2) ? "(a pass)" : "");
    add(fmt::format("G1 Z{} F300", number(-1)));
    cut(x, y);
    if (chance(6)) odd_end();
    add("G0 Z" + number(5));
    if (chance(5)) add("");
  }

  // Chords of a wave; short ones are rewritten.
  void cut(double x, double y) {
    const int lines = 2 + pick(chance(3) ? 140 : 40);
    const double step = chance(4) ? 1.5 : 0.2;
    const double height = 0.5 + pick(4);
    const double noise = chance(3) ? 0.02 : 0;
    for (int i = 1; i <= lines; ++i) {
      const double up = height * std::sin(2 * std::numbers::pi * step * i / 17) +
                        noise * (static_cast<double>(pick(200)) / 100 - 1);
      std::string line = fmt::format("X{} Y{}", number(x + step * i), number(y + up));
      if (i == 1) line = fmt::format("G1 {} F{}", line, 900 + 100 * pick(12));
      if (i > 1 && chance(60)) line += fmt::format(" F{}", 700 + 10 * pick(30));
      if (chance(90)) line += " (mark)";
      add(line);
    }
  }

  // What ends a run, changes the state or is not understood.
  void between() {
    static const std::vector<std::string> kLines = {
        "M8",         "M9",      "S8000",        "G17",         "G61",          "G64",
        "G4 P0.5",    "(PASS)",  "/ M7",         "G54",         "G80",          "#100=5",
        "G40",        "T2 M6",   "G90 G21",      "G1 X1 Y1 F0", "M123 this is", "G2 X3 Y3 I9 J2",
        "G91 G0 Z1",  "G90",     "G0 X0 A10",    "G43 H1 Z50",  "X1 X2",        "G0 G53 Z0",
        "(MSG,look)", "; words", "G1 X5 Y5 Z#3", "G18",         "G93",          "G94"};
    const int lines = chance(2) ? pick(4) : 0;
    for (int i = 0; i < lines; ++i) {
      add(kLines[static_cast<std::size_t>(pick(static_cast<int>(kLines.size())))]);
    }
    if (chance(20)) {
      for (int i = 0; i < 60; ++i) add("G2 X3 Y3 I9 J2");
    }
  }

  void odd_end() {
    add(chance(2) ? "G3 X10 Y10 I5 J0 F500" : "M98 is read (as words)");
    add("M9");
  }

  std::mt19937 random_;
  std::string line_end_;
  std::string text_;
  double scale_ = 1;
};

constexpr unsigned kSeeds = 30;

class Seed : public testing::TestWithParam<unsigned> {};

TEST_P(Seed, GivesTheSameBytesReportAndMessagesAsTheWhole) {
  const std::string text = RandomPasses(GetParam()).make();
  const SmoothOptions options = options_of_seed(GetParam());
  compare_both_ways(text, options, {1, 40, 200});
}

INSTANTIATE_TEST_SUITE_P(Windows, Seed, testing::Range(0u, kSeeds));

// The promise above would hold where every program needs the whole, and where nothing is rewritten.
TEST(Windows, AreMadeOfMostProgramsAndRewrittenThere) {
  std::size_t cut = 0;
  std::size_t rewritten = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const InWindows windows = in_windows(RandomPasses(seed).make(), options_of_seed(seed), 1);
    cut += windows.parts > 2 ? 1 : 0;
    rewritten += windows.result && rewritten_runs(*windows.result) > 1 ? 1 : 0;
  }
  EXPECT_GE(cut, kSeeds / 2);
  EXPECT_GE(rewritten, kSeeds / 3);
}

// --- the samples ---------------------------------------------------------------------------------

std::vector<std::filesystem::path> sample_programs() {
  std::vector<std::filesystem::path> programs;
  const std::filesystem::path root = std::filesystem::path(BATTEN_SOURCE_DIR) / "samples";
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    const std::string suffix = entry.path().extension().string();
    if (suffix == ".nc" || suffix == ".ngc" || suffix == ".gcode") programs.push_back(entry.path());
  }
  std::ranges::sort(programs);
  return programs;
}

TEST(Windows, GiveOfEverySampleWhatTheWholeGives) {
  const auto programs = sample_programs();
  ASSERT_GE(programs.size(), 10U);
  std::size_t cut = 0;
  for (const auto& file : programs) {
    SCOPED_TRACE(file.string());
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    SmoothOptions options = options_for("linuxcnc");
    options.method = Method::kFair;
    cut += compare_both_ways(text.str(), options, {1}) > 1 ? 1 : 0;
  }
  EXPECT_GE(cut, 3U);
}

// --- threads -------------------------------------------------------------------------------------

TEST(Windows, GiveTheSameForAnyNumberOfThreads) {
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    const std::string text = RandomPasses(seed).make();
    SmoothOptions options = options_of_seed(seed);
    const SmoothResult whole = as_a_whole(text, options);
    for (const int threads : {1, 2, 3, 8}) {
      options.threads = threads;
      const InWindows windows = in_windows(text, options, 1);
      if (windows.result) expect_same(windows, whole);
    }
  }
}

// --- what needs the whole ------------------------------------------------------------------------

// Three passes that are rewritten.
std::string passes(const std::string& before, const std::string& behind) {
  std::string text = before;
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("G0 X0 Y0 Z{}\nG1 Z-1 F300\n", 5 + i);
    text += joined(wave_lines({.lines = 60}), "\n");
  }
  return text + "G0 Z5\n" + behind;
}

constexpr std::string_view kHead = "G21 G90 G17\nS12000 M3\n";

TEST(Windows, AreMadeOfPlainPasses) {
  const InWindows windows =
      in_windows(passes(std::string(kHead), "M30\n"), options_for("linuxcnc"), 1);
  ASSERT_TRUE(windows.result);
  EXPECT_EQ(windows.parts, 4U);  // the head with the first rapid, two passes, the last with the end
  EXPECT_EQ(rewritten_runs(*windows.result), 3U);
}

TEST(Windows, SayOnceThatTheProgramIsSmoothed) {
  const InWindows windows =
      in_windows(passes(std::string(kHead), "M30\n"), options_for("linuxcnc"), 1);
  ASSERT_TRUE(windows.result);
  const std::string comment = "Batten: smoothed within";
  const std::size_t first = windows.text.find(comment);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(windows.text.find(comment, first + 1), std::string::npos);
}

TEST(Windows, KeepAProgramThatWasSmoothedWhereverThatStands) {
  const std::string text =
      passes(std::string(kHead), "M5\n(Batten: smoothed within 0.01 mm)\nM30\n");
  const InWindows windows = in_windows(text, options_for("linuxcnc"), 1);
  ASSERT_TRUE(windows.result);
  EXPECT_EQ(windows.text, text);
  expect_same(windows, as_a_whole(text, options_for("linuxcnc")));
}

struct WholeCase {
  std::string name;
  std::string before;
  std::string behind;
};

class NeedsTheWhole : public testing::TestWithParam<WholeCase> {};

TEST_P(NeedsTheWhole, AndIsNotCut) {
  const std::string text = passes(GetParam().before, GetParam().behind);
  EXPECT_FALSE(in_windows(text, options_for("linuxcnc"), 1).result) << text;
}

INSTANTIATE_TEST_SUITE_P(
    Windows, NeedsTheWhole,
    testing::Values(WholeCase{"Jump", "N5 G21 G90 G17\nS12000 M3\n", "IF [#1 EQ 1] GOTO 5\nM30\n"},
                    WholeCase{"Subprogram", std::string(kHead), "M99\n"},
                    WholeCase{"Loop", std::string(kHead) + "o1 while [#1 lt 2]\n",
                              "o1 endwhile\nM30\n"},
                    WholeCase{"WordsOutsideTheMarks", "G18\n%\n" + std::string(kHead), "M30\n%\n"},
                    WholeCase{"WordsBehindTheMarks", "%\n" + std::string(kHead), "M30\n%\nG1 X5\n"},
                    WholeCase{"NoUnits", "G90 G17\nS12000 M3\n", "M30\n"},
                    WholeCase{"AnotherLanguage", std::string(kHead), "DEF REAL DEPTH\nM30\n"},
                    WholeCase{"AnotherFamily", std::string(kHead), "G187 P3\nM30\n"}),
    [](const auto& test) { return test.param.name; });

TEST(Windows, LeaveWordsOfAProfileToTheWhole) {
  SmoothOptions options = options_for("linuxcnc");
  options.words.header = {"(made in the shop)"};
  EXPECT_FALSE(in_windows(passes(std::string(kHead), "M30\n"), options, 1).result);
}

// --- stopping ------------------------------------------------------------------------------------

TEST(Windows, StopWhereTheSinkTakesNoMore) {
  const gcode::SourceText source("part.nc", passes(std::string(kHead), "M30\n"));
  std::size_t parts = 0;
  const TextSink sink = [&](std::string_view) { return ++parts < 2; };
  const auto result =
      smooth_in_windows(source, options_for("linuxcnc"), sink, {}, {.least_blocks = 1});
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->understood);
  EXPECT_EQ(parts, 2U);
}

TEST(Windows, StopWhereTheUserWantsItAndTellHowFarTheyAre) {
  const gcode::SourceText source("part.nc", passes(std::string(kHead), "M30\n"));
  std::vector<double> told;
  const auto all = [&](double part) {
    told.push_back(part);
    return true;
  };
  const TextSink sink = [](std::string_view) { return true; };
  ASSERT_TRUE(smooth_in_windows(source, options_for("linuxcnc"), sink, all, {.least_blocks = 1})
                  ->understood);
  ASSERT_GE(told.size(), 5U);
  EXPECT_GE(told.front(), 0);
  EXPECT_LE(*std::ranges::max_element(told), 1);
  for (const std::size_t most : {std::size_t{1}, told.size() / 2}) {
    std::size_t calls = 0;
    const auto some = [&](double) { return ++calls < most; };
    EXPECT_FALSE(smooth_in_windows(source, options_for("linuxcnc"), sink, some, {.least_blocks = 1})
                     ->understood);
  }
}

}  // namespace
}  // namespace batten::postproc
