// What `explore_program` shows is what `smooth` gives, and what it recommends is no worse.
#include "postproc/stream/explore.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "postproc/stream/pipeline.h"
#include "tests/support/interpreted.h"
#include "tests/support/places.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

std::vector<SmoothOptions> settings_of(const char* target, std::vector<double> tolerances) {
  std::vector<SmoothOptions> settings;
  for (const double tolerance : tolerances) {
    for (const Form output : {Form::kAuto, Form::kArcs, Form::kLines}) {
      for (const Prefer prefer : {Prefer::kTime, Prefer::kAccuracy, Prefer::kSize}) {
        SmoothOptions& options = settings.emplace_back(options_for(target));
        options.tolerance_mm = tolerance;
        options.output = output;
        options.prefer = prefer;
      }
    }
  }
  return settings;
}

gcode::SourceText sample(const std::string& name) {
  return {name, text_of_file(std::string(BATTEN_SOURCE_DIR) + "/samples/" + name + "/program.ngc")};
}

// What the setting that is recommended takes is that of the text that was proved; of the others,
// the time of their runs and of all else.
void expect_figures(const ExploredRow& row, const SmoothResult& result) {
  const ExploredFigures& figures = row.after;
  const double elsewhere = result.program_before.seconds - result.runs_before_s;
  const double time = row.proved ? result.program_after.seconds : result.runs_after_s + elsewhere;
  EXPECT_NEAR(figures.time_s, time, 1e-9);
  EXPECT_EQ(figures.blocks, static_cast<double>(result.blocks_out));
  EXPECT_NEAR(figures.path.distance_mm, result.path_after.distance_mm, 1e-12);
  EXPECT_NEAR(figures.path.roughness, result.path_after.roughness, 1e-12);
}

// Where the proof refuses nothing, as here.
TEST(Explore, ShowsForAutoWhatSmoothGives) {
  for (const char* name : {"butterfly", "gear", "engraved_text"}) {
    SCOPED_TRACE(name);
    const gcode::SourceText source = sample(name);
    const Exploration found = explore_program(source, settings_of("linuxcnc", {0.01, 0.05}));
    ASSERT_EQ(found.rows.size(), 18u);
    for (const ExploredRow& row : found.rows) {
      if (row.options.output != Form::kAuto || row.options.prefer == Prefer::kSize) continue;
      SCOPED_TRACE(name_of(row.options.prefer));
      expect_figures(row, smooth_program(source, row.options));
    }
  }
}

bool is_as_good(const ExploredFigures& a, const ExploredFigures& b) {
  return a.time_s <= b.time_s && a.blocks <= b.blocks && a.path.distance_mm <= b.path.distance_mm &&
         a.path.roughness <= b.path.roughness;
}

TEST(Explore, MarksWhatIsDominatedAndNothingElse) {
  const Exploration found =
      explore_program(sample("butterfly"), settings_of("linuxcnc", {0.005, 0.02}));
  for (const ExploredRow& row : found.rows) {
    const bool dominated = std::ranges::any_of(found.rows, [&](const ExploredRow& other) {
      return is_as_good(other.after, row.after) && !is_as_good(row.after, other.after);
    });
    EXPECT_EQ(row.dominated, dominated);
  }
}

// Where the tool runs at its feed, four times the feed takes a quarter of the time or more.
TEST(Explore, FasterFeedsTakeNoLongerAndNoLessThanTheirShare) {
  const Exploration found = explore_program(sample("butterfly"), settings_of("linuxcnc", {0.01}));
  ASSERT_TRUE(found.recommended);
  for (const ExploredRow& row : found.rows) {
    ASSERT_EQ(row.after.at_feeds.empty(), !row.proved);
    if (!row.proved) continue;
    for (const ExploredFigures* figures : {&row.before, &row.after}) {
      ASSERT_EQ(figures->at_feeds.size(), kExploredFeeds.size());
      EXPECT_NEAR(figures->at_feeds[0], figures->time_s, 1e-9);
      for (std::size_t i = 1; i < kExploredFeeds.size(); ++i) {
        EXPECT_LE(figures->at_feeds[i], figures->at_feeds[i - 1]);
        EXPECT_GE(figures->at_feeds[i] * kExploredFeeds[i], figures->time_s * (1 - 1e-9));
      }
    }
  }
}

std::string with_feed(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

TEST(Explore, TellsForAFasterFeedWhatTheRecommendedTextTakesWithIt) {
  const std::string slow = with_feed(std::string(sample("butterfly").text()), "F6000", "F2000");
  const gcode::SourceText source("butterfly", with_feed(slow, "F600", "F200"));
  const Exploration found = explore_program(source, settings_of("linuxcnc", {0.01}));
  ASSERT_TRUE(found.recommended);
  const ExploredRow& row = found.rows[*found.recommended];
  const auto seconds_of = [&](std::string text) {
    text = with_feed(with_feed(text, "F2000", "F8000"), "F200", "F800");
    const tests::Interpreted read(text);
    return time_of(read.program, read.read, row.options).seconds;
  };
  EXPECT_NEAR(row.before.at_feeds[3], seconds_of(std::string(source.text())), 1e-9);
  EXPECT_NEAR(row.after.at_feeds[3], seconds_of(smooth_program(source, row.options).text), 1e-9);
}

// Rows of a surface, each a little higher: every third of them tells what all of them give.
TEST(Explore, OfManyRunsSomeStandForAll) {
  constexpr int kRows = 96;
  std::string text = head("G21");
  for (int row = 0; row < kRows; ++row) {
    text += fmt::format("G0 X0 Y{:.3f}\nG1 Z-1 F300\nG4 P0.1\n", 10.0 * row);
    for (int i = 1; i <= 60; ++i) {
      text += fmt::format("G1 X{:.4f} Y{:.4f} F2000\n", 0.3 * i,
                          10.0 * row + (2 + 0.02 * row) * std::sin(0.2 * i));
    }
    text += "G0 Z5\n";
  }
  const gcode::SourceText source("rows.nc", text + tail());
  const auto settings = settings_of("linuxcnc", {0.01});
  const Exploration found = explore_program(source, settings);
  ASSERT_TRUE(found.recommended);
  EXPECT_TRUE(found.rows[*found.recommended].proved);
  for (const ExploredRow& row : found.rows) {
    EXPECT_EQ(row.runs, 96u);
    EXPECT_EQ(row.runs_looked_at, 32u);
    if (row.options.output != Form::kAuto || row.options.prefer == Prefer::kSize) continue;
    SCOPED_TRACE(name_of(row.options.prefer));
    const SmoothResult smoothed = smooth_program(source, row.options);
    EXPECT_NEAR(row.after.time_s, smoothed.program_after.seconds,
                1e-3 * smoothed.program_after.seconds);
    EXPECT_NEAR(row.after.blocks, static_cast<double>(smoothed.blocks_out),
                0.02 * static_cast<double>(smoothed.blocks_in));
    EXPECT_NEAR(row.after.path.distance_mm, smoothed.path_after.distance_mm,
                0.1 * smoothed.path_before.distance_mm);
  }
}

// An estimate that is better than what is proved counts until enough is proved.
TEST(Explore, RecommendsOfProvedSettingsAloneWhereItIsAsked) {
  std::vector<ExploredRow> rows;
  for (const SmoothOptions& options : settings_of("linuxcnc", {0.01})) {
    ExploredRow& row = rows.emplace_back(ExploredRow{options, {}, {}});
    row.before.time_s = 100;
    row.before.blocks = 1000;
    row.after = row.before;
    row.after.rewritten = true;
  }
  rows[0].after.time_s = 60;
  rows[1].after.time_s = 80;
  rows[2].after.time_s = 70;
  EXPECT_EQ(recommended_row(rows), 0u);
  EXPECT_EQ(recommended_row(rows, true), std::nullopt);
  rows[1].proved = rows[2].proved = true;
  EXPECT_EQ(recommended_row(rows, true), 2u);
}

TEST(Explore, IsTheSameForAnyNumberOfThreads) {
  const gcode::SourceText source = sample("engraved_text");
  std::vector<SmoothOptions> settings = settings_of("grbl", {0.01});
  const Exploration all = explore_program(source, settings);
  for (SmoothOptions& options : settings) options.threads = 1;
  const Exploration one = explore_program(source, settings);
  EXPECT_EQ(all.recommended, one.recommended);
  for (std::size_t i = 0; i < one.rows.size(); ++i) {
    EXPECT_EQ(all.rows[i].after.time_s, one.rows[i].after.time_s);
    EXPECT_EQ(all.rows[i].after.at_feeds, one.rows[i].after.at_feeds);
  }
}

TEST(Explore, RecommendsNothingWhereNothingIsGainedOrUnderstood) {
  const auto settings = settings_of("linuxcnc", {0.01});
  const gcode::SourceText lines("lines.ngc", head("G21") + "G1 X10 F500\nX20 Y10\n" + tail());
  const Exploration kept = explore_program(lines, settings);
  EXPECT_EQ(kept.rows.size(), settings.size());
  EXPECT_FALSE(kept.recommended);
  const gcode::SourceText no_units("none.ngc", wave_program({}, "G94"));
  const Exploration refused = explore_program(no_units, settings);
  EXPECT_FALSE(refused.read.understood);
  EXPECT_TRUE(refused.rows.empty());
  EXPECT_FALSE(
      explore_program(sample("butterfly"), settings, [](double) { return false; }).read.understood);
}

}  // namespace
}  // namespace batten::postproc
