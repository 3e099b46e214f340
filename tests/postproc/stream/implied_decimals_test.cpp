// Programs in which X1000 may be 1000 mm or 1.000 mm: kept, or read as the user says, and what is
// written is right in every reading that was possible.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "gcode/state/reason.h"
#include "gcode/text/language.h"
#include "postproc/options/options.h"
#include "postproc/stream/part_reader.h"
#include "tests/support/constructs.h"
#include "tests/support/in_windows.h"

namespace batten::postproc {
namespace {

using gcode::Decimals;

constexpr Decimals kExplicit{};
constexpr Decimals kIncrements{.pointless = gcode::PointlessNumbers::kIncrements};

// A wave whose numbers are least increments: of 0.001 mm, or of 0.0001 inch.
std::string wave_in_increments(const std::string& units = "G21") {
  std::string text = "%\nO1000\n" + units + " G90 G17\nG0 X0 Y0 Z5000\nG1 Z-1000 F300\n";
  for (int i = 1; i <= 200; ++i) {
    const double y = 2000 * std::sin(2 * 3.14159265 * i / 90);
    text += fmt::format("X{} Y{:.0f}{}\n", 200 * i, y, i == 1 ? " F2000" : "");
  }
  return text + "G0 Z5000\nM30\n%\n";
}

// The same program with its points written.
std::string with_points(const std::string& increments, int decimals) {
  std::string text;
  for (std::size_t i = 0; i < increments.size();) {
    const char c = increments[i++];
    text += c;
    if (c != 'X' && c != 'Y' && c != 'Z') continue;
    std::size_t end = i;
    while (end < increments.size() &&
           std::string("-0123456789").find(increments[end]) != std::string::npos)
      ++end;
    const double value = std::stod(increments.substr(i, end - i)) * std::pow(10.0, -decimals);
    text += fmt::format("{:.{}f}", value, decimals);
    i = end;
  }
  return text;
}

SmoothOptions undeclared(const char* target) {
  SmoothOptions options = options_for(target);
  options.decimals.reset();
  return options;
}

SmoothOptions with_decimals(const char* target, const Decimals& decimals) {
  SmoothOptions options = options_for(target);
  options.decimals = decimals;
  return options;
}

// The verdict of a reader that takes numbers without a point so.
bool is_proved(const std::string& before, const std::string& after, const Decimals& decimals) {
  const auto read = [&](const std::string& text) {
    gcode::Diagnostics ignored;
    return read_whole(gcode::SourceText("test.nc", text),
                      {.text = {gcode::Language::kRs274, decimals}}, ignored);
  };
  const gcode::ReadPart old_text = read(before);
  const gcode::ReadPart new_text = read(after);
  return verify({&old_text.program, &old_text.meaning}, {&new_text.program, &new_text.meaning},
                0.01)
      .proved();
}

TEST(ImpliedDecimals, UndeclaredProgramsStayAsTheyAreWithTheReason) {
  for (const char* target : {"fanuc", "haas", "mitsubishi", "okuma", "brother", "mazak"}) {
    SCOPED_TRACE(target);
    const std::string before = wave_in_increments();
    const SmoothResult result = smoothed(before, undeclared(target));
    EXPECT_TRUE(result.understood);
    EXPECT_EQ(result.text, before);
    EXPECT_EQ(rewritten_runs(result), 0U);
    ASSERT_EQ(result.diagnostics.size(), 1U);
    EXPECT_EQ(result.diagnostics[0].id, "implied-decimals");
    EXPECT_EQ(
        gcode::to_text(result.diagnostics[0], gcode::SourceText("old.nc", before)).substr(0, 12),
        "old.nc:4:10:");
    EXPECT_EQ(reason_at(inspected(before, undeclared(target)), 100),
              gcode::reason::kImpliedDecimals);
  }
}

TEST(ImpliedDecimals, OtherControlsReadThemAsEver) {
  for (const char* target : {"linuxcnc", "grbl", "marlin", "mach3"}) {
    SCOPED_TRACE(target);
    const SmoothResult result = smoothed(wave_in_increments(), undeclared(target));
    EXPECT_TRUE(result.understood);
    EXPECT_TRUE(result.diagnostics.empty());
    const bool named = std::ranges::any_of(result.runs, [](const RunReport& run) {
      return run.reason == gcode::reason::kImpliedDecimals;
    });
    EXPECT_FALSE(named);
  }
}

TEST(ImpliedDecimals, DeclaredOnesAreTheProgramWithItsPointsWritten) {
  for (const char* target : {"fanuc", "haas"}) {
    SCOPED_TRACE(target);
    const std::string before = wave_in_increments();
    const SmoothResult implied = smoothed(before, with_decimals(target, kIncrements));
    const SmoothResult written =
        smoothed(with_points(before, 3), with_decimals(target, kIncrements));
    ASSERT_EQ(rewritten_runs(implied), 1U);
    ASSERT_EQ(implied.runs.size(), written.runs.size());
    for (std::size_t i = 0; i < implied.runs.size(); ++i) {
      EXPECT_EQ(implied.runs[i].deviation_mm, written.runs[i].deviation_mm);
      EXPECT_EQ(implied.runs[i].time_before_s, written.runs[i].time_before_s);
    }
    EXPECT_TRUE(implied.proved);
    expect_rest_copied(before, implied);
    EXPECT_LE(implied.deviation_mm, 0.01);
  }
}

// The written text is the same path for a reader of increments, with points written or not.
TEST(ImpliedDecimals, EveryWrittenLengthHasAPoint) {
  for (const char* units : {"G21", "G20"}) {
    SCOPED_TRACE(units);
    const std::string before = wave_in_increments(units);
    const SmoothResult result = smoothed(before, with_decimals("fanuc", kIncrements));
    ASSERT_EQ(rewritten_runs(result), 1U);
    const std::vector<std::string> old_lines = lines_of(before);
    for (const std::string& whole : lines_of(result.text)) {
      if (std::ranges::find(old_lines, whole) != old_lines.end()) continue;
      const std::string line = whole.substr(0, whole.find('('));
      for (std::size_t i = 0; i < line.size(); ++i) {
        if (std::string("XYZIJK").find(line[i]) == std::string::npos) continue;
        const std::size_t end = std::min(line.find_first_of(" XYZIJKRF", i + 1), line.size());
        EXPECT_NE(line.substr(i, end - i).find('.'), std::string::npos) << line;
      }
    }
    EXPECT_TRUE(is_proved(before, result.text, kIncrements));
    EXPECT_FALSE(is_proved(before, result.text, kExplicit));
  }
}

TEST(ImpliedDecimals, ExplicitOnesAreUnitsOnThoseControlsToo) {
  const std::string before = wave_program({.step = 2, .height = 40, .length = 120, .decimals = 0});
  const SmoothResult kept = smoothed(before, undeclared("fanuc"));
  EXPECT_EQ(kept.text, before);
  const SmoothResult result = smoothed(before, with_decimals("fanuc", kExplicit));
  EXPECT_TRUE(result.diagnostics.empty());
  EXPECT_TRUE(is_proved(before, result.text, kExplicit));
}

// Nobody said what these mean, so nothing may depend on it.
TEST(ImpliedDecimals, WhatIsWrittenUndeclaredHoldsInEitherReading) {
  for (const int every : {3, 17, 40, 77}) {
    SCOPED_TRACE(every);
    std::string before = "G21 G90 G17\nG0 X0. Y0. Z5\nG1 Z-1 F300\n";
    int i = 0;
    for (const std::string& line : wave_lines({.lines = 240})) {
      // Here and there a coordinate without a point.
      before += ++i % every == 0 ? fmt::format("X{}\n", i) : line + "\n";
    }
    before += "G0 Z5\nM30\n";
    const SmoothResult result = smoothed(before, undeclared("fanuc"));
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result) > 0, every > 3);
    EXPECT_TRUE(is_proved(before, result.text, kExplicit));
    EXPECT_TRUE(is_proved(before, result.text, kIncrements));
    expect_rest_copied(before, result);
  }
}

TEST(ImpliedDecimals, FeedsKeepTheWayTheyWereWritten) {
  const std::string points = wave_program({.feed = 2000});
  std::string feeds_with_points = points;
  feeds_with_points.replace(feeds_with_points.find("F300"), 4, "F300.");
  feeds_with_points.replace(feeds_with_points.find("F2000"), 5, "F2000.");
  const std::string without = smoothed(points, undeclared("fanuc")).text;
  const std::string with_them = smoothed(feeds_with_points, undeclared("fanuc")).text;
  EXPECT_NE(without, points);
  EXPECT_NE(without.find("F2000\n"), std::string::npos);
  EXPECT_EQ(without.find("F2000."), std::string::npos);
  EXPECT_NE(with_them.find("F2000.\n"), std::string::npos);
  EXPECT_EQ(with_them.find("F2000\n"), std::string::npos);
}

// F100 and F100. may be two feeds.
TEST(ImpliedDecimals, TheProofTellsFeedsWithAndWithoutAPointApart) {
  const std::string before = "G21 G90\nG0 X0 Y0 Z0\nG1 X1. F100\nX2. Y1.\nX3.\nG0 Z5.\n";
  std::string after = before;
  after.replace(after.find("F100"), 4, "F100.");
  const Decimals undeclared{.pointless = gcode::PointlessNumbers::kUndeclared};
  EXPECT_TRUE(is_proved(before, before, undeclared));
  EXPECT_FALSE(is_proved(before, after, undeclared));
  EXPECT_FALSE(is_proved(before, after, kIncrements));
  EXPECT_TRUE(is_proved(before, after, kExplicit));
}

TEST(ImpliedDecimals, LongProgramsAreReadSoWindowByWindow) {
  const std::string wave = wave_in_increments();
  const std::string pass = wave.substr(wave.find("G0 X0"), wave.find("M30") - wave.find("G0 X0"));
  const std::string before = "G21 G90 G17\n" + pass + pass + pass + pass + "M30\n";
  for (const bool declared : {true, false}) {
    SmoothOptions options = undeclared("fanuc");
    if (declared) options.decimals = kIncrements;
    const InWindows windows = in_windows(before, options, 100);
    const SmoothResult whole = smoothed(before, options);
    EXPECT_EQ(rewritten_runs(whole), declared ? 4U : 0U);
    EXPECT_TRUE(windows.cut() || !declared);
    EXPECT_EQ(windows.text, whole.text);
  }
}

TEST(DecimalsOption, ReadsWhatItWritesAndRefusesIncrementsThatNoControlHas) {
  for (const char* text : {"auto", "explicit", "implied", "implied:0.0001", "implied:1"}) {
    std::vector<std::string> problems;
    EXPECT_EQ(text_of(read_decimals(text, problems)), text);
    EXPECT_TRUE(problems.empty());
  }
  std::vector<std::string> problems;
  EXPECT_EQ(text_of(read_decimals("implied:0.001", problems)), "implied");
  EXPECT_TRUE(problems.empty());
  for (const char* text : {"", "yes", "implied:", "implied:0.002", "implied:0.01mm", "Implied"}) {
    problems.clear();
    EXPECT_EQ(read_decimals(text, problems), std::nullopt);
    EXPECT_EQ(problems.size(), 1U) << text;
  }
}

TEST(DecimalsOption, IncrementsNeedAControlThatHasThem) {
  EXPECT_TRUE(problems_of(with_decimals("fanuc", kIncrements)).empty());
  EXPECT_TRUE(problems_of(with_decimals("linuxcnc", kExplicit)).empty());
  EXPECT_EQ(problems_of(with_decimals("linuxcnc", kIncrements)),
            std::vector<std::string>{"--decimals: implied: this target takes X5 for 5 mm, and "
                                     "blocks are copied to it"});
  SmoothOptions options = with_decimals("fanuc", kIncrements);
  options.source = gcode::SourceKind::kNgc;
  EXPECT_EQ(problems_of(options),
            std::vector<std::string>{
                "--decimals: implied: programs for this source have no such numbers"});
  EXPECT_EQ(problems_of_decimals(kIncrements, gcode::SourceKind::kAuto, nullptr),
            std::vector<std::string>{"--decimals: implied: say --source fanuc or haas"});
}

}  // namespace
}  // namespace batten::postproc
