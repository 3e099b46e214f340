// Programs that are smoothed window by window come out as they do as a whole: the same bytes, the
// same report, the same messages.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "postproc/stream/pipeline.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/window.h"
#include "tests/support/in_windows.h"
#include "tests/support/places.h"
#include "tests/support/random_passes.h"
#include "tests/support/wavy_programs.h"

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
std::string passes_of_windows(const std::string& before, const std::string& behind) {
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
      in_windows(passes_of_windows(std::string(kHead), "M30\n"), options_for("linuxcnc"), 1);
  ASSERT_TRUE(windows.result);
  EXPECT_EQ(windows.parts, 4U);  // the head with the first rapid, two passes, the last with the end
  EXPECT_EQ(rewritten_runs(*windows.result), 3U);
}

TEST(Windows, SayOnceThatTheProgramIsSmoothed) {
  const InWindows windows =
      in_windows(passes_of_windows(std::string(kHead), "M30\n"), options_for("linuxcnc"), 1);
  ASSERT_TRUE(windows.result);
  const std::string comment = "Batten: smoothed within";
  const std::size_t first = windows.text.find(comment);
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(windows.text.find(comment, first + 1), std::string::npos);
}

TEST(Windows, KeepAProgramThatWasSmoothedWhereverThatStands) {
  const std::string text =
      passes_of_windows(std::string(kHead), "M5\n(Batten: smoothed within 0.01 mm)\nM30\n");
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
  const std::string text = passes_of_windows(GetParam().before, GetParam().behind);
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
  EXPECT_FALSE(in_windows(passes_of_windows(std::string(kHead), "M30\n"), options, 1).result);
}

// --- stopping ------------------------------------------------------------------------------------

TEST(Windows, StopWhereTheSinkTakesNoMore) {
  const gcode::SourceText source("part.nc", passes_of_windows(std::string(kHead), "M30\n"));
  std::size_t parts = 0;
  const TextSink sink = [&](std::string_view) { return ++parts < 2; };
  const auto result =
      smooth_in_windows(source, options_for("linuxcnc"), sink, {}, {.least_blocks = 1});
  ASSERT_TRUE(result);
  EXPECT_FALSE(result->understood);
  EXPECT_EQ(parts, 2U);
}

TEST(Windows, StopWhereTheUserWantsItAndTellHowFarTheyAre) {
  const gcode::SourceText source("part.nc", passes_of_windows(std::string(kHead), "M30\n"));
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

// --- one way for both ----------------------------------------------------------------------------

struct Streamed {
  SmoothResult result;
  std::string text;
  std::size_t restarts = 0;
};

Streamed streamed(const std::string& text, const StreamLimits& limits) {
  Streamed done;
  const ProgramSink sink{[&](std::string_view part) {
                           done.text += part;
                           return true;
                         },
                         [&] {
                           done.text.clear();
                           ++done.restarts;
                           return true;
                         }};
  const gcode::SourceText source("part.nc", text);
  done.result = smooth_program(source, options_for("linuxcnc"), sink, {}, limits);
  return done;
}

TEST(Pipeline, HandsOnTheSameTextInWindowsAndAsOne) {
  const std::string text = passes_of_windows(std::string(kHead), "M30\n");
  const SmoothResult whole = as_a_whole(text, options_for("linuxcnc"));
  const Streamed as_one = streamed(text, {});
  const Streamed windows = streamed(text, {.bytes_for_windows = 0, .windows = {.least_blocks = 1}});
  EXPECT_EQ(as_one.text, whole.text);
  EXPECT_EQ(windows.text, whole.text);
  EXPECT_EQ(as_one.result.bytes_out(), whole.bytes_out());
  EXPECT_EQ(windows.result.bytes_out(), whole.bytes_out());
  EXPECT_EQ(as_one.restarts + windows.restarts, 0U);
}

TEST(Pipeline, BeginsTheTextAnewWhereWindowsAreNotEnough) {
  const std::string text = passes_of_windows(std::string(kHead), "M99\n");
  const Streamed done = streamed(text, {.bytes_for_windows = 0, .windows = {.least_blocks = 1}});
  EXPECT_EQ(done.restarts, 1U);
  EXPECT_EQ(done.text, as_a_whole(text, options_for("linuxcnc")).text);
}

}  // namespace
}  // namespace batten::postproc
