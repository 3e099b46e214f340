// Programs that are smoothed window by window come out as they do as a whole: the same bytes, the
// same report, the same messages.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <optional>

#include "postproc/stream/pipeline.h"
#include "postproc/stream/prescan.h"
#include "postproc/stream/window.h"
#include "tests/support/in_windows.h"
#include "tests/support/random_passes.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// Returns how many windows there were, as many as `least_blocks` allow.
// But for what the runs of a window share.
std::size_t compare_both_ways(const std::string& text, SmoothOptions options,
                              std::initializer_list<std::size_t> least_blocks) {
  options.share_work = false;
  std::size_t most = 0;
  std::optional<SmoothResult> whole;
  for (const std::size_t least : least_blocks) {
    SCOPED_TRACE(testing::Message() << "windows of " << least << " blocks and more");
    const InWindows windows = in_windows(text, options, least);
    if (!whole) whole = as_a_whole(text, options);
    expect_same(windows, *whole);
    most = std::max(most, windows.parts);
  }
  return most;
}

constexpr unsigned kSeeds = 20;

class Seed : public testing::TestWithParam<unsigned> {};

TEST_P(Seed, GivesTheSameBytesReportAndMessagesAsTheWholeForAnyThreads) {
  const std::string text = RandomPasses(GetParam()).make();
  SmoothOptions options = options_of_seed(GetParam());
  compare_both_ways(text, options, {1, 40, 200});
  if (GetParam() >= 8) return;
  for (const int threads : {1, 2, 3, 8}) {
    SCOPED_TRACE(threads);
    options.threads = threads;
    compare_both_ways(text, options, {1});
  }
}

INSTANTIATE_TEST_SUITE_P(Windows, Seed, testing::Range(0u, kSeeds));

// The promise above would hold where every program needs the whole, and where nothing is rewritten.
TEST(Windows, AreMadeOfMostProgramsAndRewrittenThere) {
  std::size_t cut = 0;
  std::size_t rewritten = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const InWindows windows = in_windows(RandomPasses(seed).make(), options_of_seed(seed), 1);
    cut += windows.parts > 2 ? 1 : 0;
    rewritten += windows.cut() && rewritten_runs(windows.result) > 1 ? 1 : 0;
  }
  EXPECT_GE(cut, kSeeds / 2);
  EXPECT_GE(rewritten, kSeeds / 3);
}

TEST(Windows, GiveOfEverySampleWhatTheWholeGives) {
  std::size_t cut = 0;
  for (const auto& [file, text] : sample_programs()) {
    SCOPED_TRACE(file);
    SmoothOptions options = options_for("linuxcnc");
    options.method = Method::kFair;
    cut += compare_both_ways(text, options, {1}) > 1 ? 1 : 0;
  }
  EXPECT_GE(cut, 3U);
}

// Three passes that are rewritten.
std::string passes_of_windows(const std::string& before, const std::string& behind) {
  std::string text = before;
  for (int i = 0; i < 3; ++i) {
    text += fmt::format("G0 X0 Y0 Z{}\nG1 Z-1 F300\n", 5 + i);
    text += joined(wave_lines({.lines = 60}), "\n");
  }
  return text + "G0 Z5\n" + behind;
}

const std::string kHead = "G21 G90 G17\nS12000 M3\n";
const std::string kPlain = passes_of_windows(kHead, "M30\n");

TEST(Windows, AreMadeOfPlainPassesAndSayOnceThatTheProgramIsSmoothed) {
  const InWindows windows = in_windows(kPlain, options_for("linuxcnc"), 1);
  EXPECT_EQ(windows.parts, 4U);  // the head with the first rapid, two passes, the last with the end
  EXPECT_EQ(rewritten_runs(windows.result), 3U);
  const std::size_t first = windows.text.find("Batten: smoothed within");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(windows.text.find("Batten: smoothed within", first + 1), std::string::npos);
}

// A wave that is 4 % faster in half as many blocks again is worth that for itself, but not beside
// what takes twenty times as long and stays as it is.
TEST(Windows, AreNotLargerTogetherForTooLittle) {
  const Wave fast{.lines = 80, .step = 0.3, .height = 1, .length = 6, .feed = 6000};
  const std::string wave = "G0 Z5\nG0 X0 Y0\nG1 Z-1 F300\n" + joined(wave_lines(fast), "\n");
  std::string slow = "G0 Z5\nG0 X0 Y0\nG1 Z-1 F300\n";
  for (int i = 1; i <= 40; ++i) slow += fmt::format("G1 X{} Y{} F600\n", i, 2 * (i % 2));
  const SmoothOptions options = options_for("linuxcnc");
  const std::string end = "G0 Z5\nM2\n";
  const InWindows alone = in_windows(kHead + wave + end, options, 1);
  EXPECT_GT(alone.result.blocks_out, alone.result.blocks_in + 20);
  for (const auto& [text, restarts] :
       {std::pair{kHead + slow + wave + end, 0U}, std::pair{kHead + wave + slow + end, 1U}}) {
    const InWindows windows = in_windows(text, options, WindowLimits{.least_blocks = 1}, true);
    EXPECT_EQ(windows.restarts, restarts);
    EXPECT_EQ(windows.cut(), restarts == 0);
    EXPECT_LE(windows.result.blocks_out, windows.result.blocks_in + 1);
    EXPECT_EQ(in_windows(text, options, 1).restarts, 1U) << "not mended";
  }
}

TEST(Windows, KeepAProgramThatWasSmoothedWhereverThatStands) {
  const std::string text = passes_of_windows(kHead, "M5\n(Batten: smoothed within 0.01 mm)\nM30\n");
  const InWindows windows = in_windows(text, options_for("linuxcnc"), 1);
  EXPECT_TRUE(windows.cut());
  EXPECT_EQ(windows.text, text);
  expect_same(windows, as_a_whole(text, options_for("linuxcnc")));
}

// Closed runs in two windows, none of which gains by a form of its own.
TEST(Windows, NoteOnceThatNoSeamIsRounded) {
  const std::string ring = "G1 X20 F300\nX10 Y17\nX0 Y0\n";
  const std::string rings = "G1 X0 Y0\nG0 Z5\nG0 X0 Y0\nG1 Z-1 F300\n" + ring +
                            "G0 Z6\nG0 X0 Y0\nG1 Z-2 F300\n" + ring + "G0 Z6\nM30\n";
  SmoothOptions options = options_for("linuxcnc");
  options.method = Method::kGuo;
  options.seam = geometry::Seam::kSmooth;
  const std::string text = passes_of_windows(kHead, rings);
  const InWindows windows = in_windows(text, options, 1);
  EXPECT_GE(windows.parts, 5U);
  expect_same(windows, as_a_whole(text, options));
  const auto note =
      std::ranges::find(windows.result.diagnostics, "seam-not-rounded", &gcode::Diagnostic::id);
  ASSERT_NE(note, windows.result.diagnostics.end());
  EXPECT_NE(note->message.find("2 closed runs"), std::string::npos) << note->message;
  EXPECT_EQ(note->where.begin, text.find(ring));
}

struct WholeCase {
  std::string name;
  std::string before;
  std::string behind;
};

class IsOneWindow : public testing::TestWithParam<WholeCase> {};

TEST_P(IsOneWindow, AndIsNotCut) {
  const std::string text = passes_of_windows(GetParam().before, GetParam().behind);
  EXPECT_FALSE(in_windows(text, options_for("linuxcnc"), 1).cut()) << text;
}

INSTANTIATE_TEST_SUITE_P(
    Windows, IsOneWindow,
    testing::Values(WholeCase{"Jump", "N5 G21 G90 G17\nS12000 M3\n", "IF [#1 EQ 1] GOTO 5\nM30\n"},
                    WholeCase{"Subprogram", kHead, "M99\n"},
                    WholeCase{"Loop", kHead + "o1 while [#1 lt 2]\n", "o1 endwhile\nM30\n"},
                    WholeCase{"WordsOutsideTheMarks", "G18\n%\n" + kHead, "M30\n%\n"},
                    WholeCase{"WordsBehindTheMarks", "%\n" + kHead, "M30\n%\nG1 X5\n"},
                    WholeCase{"NoUnits", "G90 G17\nS12000 M3\n", "M30\n"},
                    WholeCase{"AnotherLanguage", kHead, "DEF REAL DEPTH\nM30\n"},
                    WholeCase{"AnotherFamily", kHead, "G187 P3\nM30\n"}),
    [](const auto& test) { return test.param.name; });

TEST(Windows, AreOneWithWordsOfAProfile) {
  SmoothOptions options = options_for("linuxcnc");
  options.words.header = {"(made in the shop)"};
  EXPECT_EQ(in_windows(kPlain, options, 1).parts, 1U);
}

constexpr StreamLimits kMany = {.bytes_for_windows = 0, .windows = {.least_blocks = 1}};

TEST(Windows, StopWhereTheSinkTakesNoMore) {
  const gcode::SourceText source("part.nc", kPlain);
  std::size_t parts = 0;
  const ProgramSink sink = {[&](std::string_view) { return ++parts < 2; }, {}};
  EXPECT_FALSE(smooth_program(source, options_for("linuxcnc"), sink, {}, kMany).understood);
  EXPECT_EQ(parts, 2U);
}

TEST(Windows, StopWhereTheUserWantsItAndTellHowFarTheyAre) {
  const gcode::SourceText source("part.nc", kPlain);
  const SmoothOptions options = options_for("linuxcnc");
  for (const StreamLimits& limits : {kMany, StreamLimits{}}) {
    std::vector<double> told;
    const auto all = [&](double part) {
      told.push_back(part);
      return true;
    };
    ASSERT_TRUE(smooth_program(source, options, all, limits).understood);
    ASSERT_GE(told.size(), 5U);
    EXPECT_GE(told.front(), 0);
    EXPECT_LE(*std::ranges::max_element(told), 1);
    for (const std::size_t most : {std::size_t{1}, told.size() / 2}) {
      std::size_t calls = 0;
      const auto some = [&](double) { return ++calls < most; };
      EXPECT_FALSE(smooth_program(source, options, some, limits).understood);
    }
  }
}

TEST(Pipeline, HandsOnTheSameTextInWindowsAndAsOne) {
  const SmoothResult whole = as_a_whole(kPlain, options_for("linuxcnc"));
  const InWindows windows = in_windows(kPlain, options_for("linuxcnc"), 1);
  const InWindows one = in_windows(kPlain, options_for("linuxcnc"), kPlain.size());
  EXPECT_EQ(one.parts, 1U);
  EXPECT_EQ(one.text, whole.text);
  EXPECT_EQ(windows.text, whole.text);
  EXPECT_EQ(one.result.bytes_out, whole.bytes_out);
  EXPECT_EQ(windows.result.bytes_out, whole.bytes_out);
  EXPECT_EQ(one.restarts + windows.restarts, 0U);
}

}  // namespace
}  // namespace batten::postproc
