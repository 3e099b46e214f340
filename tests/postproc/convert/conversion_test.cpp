#include "postproc/convert/conversion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "gcode/controls/built_in.h"
#include "gcode/state/source_marks.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using gcode::SourceMark;

std::vector<SourceMark> marks_in(const std::string& text) {
  const ReadText read(text);
  std::vector<SourceMark> marks;
  for (const gcode::FoundMark& found : gcode::source_marks(read.program)) {
    marks.push_back(found.mark);
  }
  return marks;
}

TEST(SourceMarks, AreFoundByTheWordsOfAFamily) {
  using Marks = std::vector<SourceMark>;
  EXPECT_EQ(marks_in("G21\nG64\nG1 X1\n"), Marks{});
  EXPECT_EQ(marks_in("G64 P0.01\n"), Marks{SourceMark::kBlendTolerance});
  EXPECT_EQ(marks_in("O100 sub\nG1 X1\nO100 endsub\n"), Marks{SourceMark::kSubWords});
  EXPECT_EQ(marks_in("O1000\nG1 X1\n"), Marks{});
  EXPECT_EQ(marks_in("#<depth> = 3\n"), Marks{SourceMark::kNamedParameters});
  EXPECT_EQ(marks_in("N10 IF [#1 EQ 2] GOTO 20\n"), Marks{SourceMark::kMacroFlow});
  EXPECT_EQ(marks_in("G05.1 Q1\n"), Marks{SourceMark::kHighSpeedMode});
  EXPECT_EQ(marks_in("G5 P10000\n"), Marks{SourceMark::kHighSpeedMode});
  EXPECT_EQ(marks_in("G5.1 X1 Y1 I1 J1\n"), Marks{});
  EXPECT_EQ(marks_in("G5.2 X1 Y1 P1 L4\n"), Marks{SourceMark::kUniformNurbs});
  EXPECT_EQ(marks_in("G5.3 P10\n"), Marks{});
  EXPECT_EQ(marks_in("G187 P1\n"), Marks{SourceMark::kHaasSmoothness});
  EXPECT_EQ(marks_in("G131 F100 J1\n"), Marks{SourceMark::kSuperNurbs});
  EXPECT_EQ(marks_in("M104 S200\n"), Marks{SourceMark::kHeaterWords});
  EXPECT_EQ(marks_in("M104\n"), Marks{});
  EXPECT_EQ(marks_in("$H\n"), Marks{SourceMark::kDollarLine});
  EXPECT_EQ(marks_in("#HSC ON\n"), Marks{SourceMark::kHashCommand});
  EXPECT_EQ(marks_in("(G187)\n"), Marks{});
}

bool has_error_of(const SmoothResult& result, std::string_view id) {
  return std::ranges::any_of(result.diagnostics,
                             [id](const gcode::Diagnostic& each) { return each.id == id; });
}

TEST(OtherFamily, IsRefused) {
  const std::string text = "G64 P0.01\n" + wave_program();
  EXPECT_TRUE(smoothed(text, options_for("linuxcnc")).understood);
  const SmoothResult result = smoothed(text, options_for("haas"));
  EXPECT_FALSE(result.understood);
  EXPECT_EQ(result.text, "");
  EXPECT_TRUE(has_error_of(result, "other-family"));
}

TEST(OtherFamily, IsNoMatterWhereNothingWouldBeRewritten) {
  const std::string text = "G21 G90\nG64 P0.01\nG0 X1\nG1 X2 F100\nM2\n";
  const SmoothResult result = smoothed(text, options_for("haas"));
  EXPECT_TRUE(result.understood);
  EXPECT_EQ(result.text, text);
}

TEST(Conversion, ListsTheBlocksThatCannotBeSaid) {
  SmoothOptions options = options_for("haas");
  options.convert = true;
  const std::string text = "G64 P0.01\n" + wave_program({}, "G21 G54\nG81 X1 Y1 Z-1 R1 F100\nG80");
  const SmoothResult result = smoothed(text, options);
  EXPECT_FALSE(result.understood);
  std::vector<std::string> told;
  for (const gcode::Diagnostic& each : result.diagnostics) {
    if (each.id == "cannot-convert") told.push_back(each.message);
  }
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0], "G64 may mean something else there (target haas)");
  EXPECT_EQ(told[1], "G81 may mean something else there (target haas)");
}

std::vector<std::string> obstacles(const std::string& text, std::string_view target) {
  const ReadText read(text);
  gcode::Diagnostics found;
  tell_what_cannot_be_said(read.program, *gcode::find_control(target), found);
  std::vector<std::string> messages;
  for (const gcode::Diagnostic& each : found) messages.push_back(each.message);
  return messages;
}

TEST(Conversion, TakesAProgramOfCommonWords) {
  const std::string text =
      "%\nG21 G90 G17 G40 G49 G80\nG54\nT1 M6\nS12000 M3\nG43 H1\nG0 X0 Y0 Z5\nM8\nG1 Z-1 F300\n"
      "G3 X1 Y1 I0 J1\n(side)\nG0 Z5\nM9\nM5\nM30\n%\n";
  EXPECT_EQ(obstacles(text, "haas"), std::vector<std::string>{});
  EXPECT_EQ(obstacles(text, "mazak"), std::vector<std::string>{});
  EXPECT_EQ(obstacles(text, "linuxcnc"), std::vector<std::string>{});
}

TEST(Conversion, NamesWhatEachTargetCannotBeTold) {
  const auto first = [](const std::string& text, std::string_view target) {
    const auto all = obstacles(text, target);
    return all.empty() ? std::string("taken") : all.front();
  };
  EXPECT_EQ(first("T1 M6\n", "grbl"), "M6 is not taken there (target grbl)");
  EXPECT_EQ(first("G43 H1\n", "fagor"), "G43 is not taken there (target fagor)");
  EXPECT_EQ(first("G54\n", "okuma"), "G54 is not taken there (target okuma)");
  EXPECT_EQ(first("G21\n", "beckhoff"),
            "G21 mirrors the path on this control, whose units are G70 and G71 (target beckhoff)");
  EXPECT_EQ(first("G3 X1 I1\n", "num"), "I1 may be no offset there (target num)");
  EXPECT_EQ(first("G18\n", "marlin"), "G18 is no plane of arcs there (target marlin)");
  EXPECT_EQ(
      first("X1 Y1\n", "klipper"),
      "X1 Y1 names no G0, G1, G2 or G3, which the target needs in every block (target klipper)");
  EXPECT_EQ(first("(text)\n", "klipper"), "(text) is no comment there (target klipper)");
  EXPECT_EQ(first("; text\n", "klipper"), "taken");
  EXPECT_EQ(first("G28 Z0\n", "haas"), "G28 may mean something else there (target haas)");
  EXPECT_EQ(first("G1 X1 A5\n", "haas"), "A5 may mean something else there (target haas)");
  EXPECT_EQ(first("H5\n", "haas"), "H5 may mean something else there (target haas)");
  EXPECT_EQ(first("/G1 X1\n", "haas"),
            "/G1 X1 is left out by some controls, run by others (target haas)");
  EXPECT_EQ(first("#1=5\n", "haas"), "#1=5 is no block of plain words (target haas)");
}

TEST(Conversion, DoesNotBuryItsReader) {
  std::string text;
  for (int i = 0; i < 120; ++i) text += "G28 Z0\n";
  const auto told = obstacles(text, "haas");
  ASSERT_EQ(told.size(), 51U);
  EXPECT_EQ(told.back(), "from here on 70 more blocks of this kind");
}

// --- words that the reader and the target understand differently --------------------------------

TEST(OtherMeanings, AreAnErrorWhoeverConverts) {
  for (const bool convert : {false, true}) {
    SmoothOptions options = options_for("beckhoff");
    options.convert = convert;
    const SmoothResult result = smoothed(wave_program(), options);
    EXPECT_FALSE(result.understood);
    EXPECT_TRUE(has_error_of(result, "word-means-other"));
  }
  EXPECT_TRUE(smoothed(wave_program({}, "G71"), options_for("beckhoff")).understood);
  EXPECT_TRUE(
      has_error_of(smoothed(wave_program({}, "G20"), options_for("klipper")), "word-means-other"));
}

// G51 and G52 choose zero points; G14 repeats blocks, whose lines may not be rewritten.
TEST(OtherMeanings, OfZeroPointsAreReadAsTheControlDoes) {
  const std::string zeros = wave_program({}, "G71\nG51\nG52");
  const SmoothResult elsewhere = smoothed(zeros, options_for("fanuc"));
  EXPECT_EQ(elsewhere.blocks_out, elsewhere.blocks_in);
  const SmoothResult there = smoothed(zeros, options_for("philips"));
  EXPECT_LT(there.blocks_out, there.blocks_in);
  const std::string repeats = wave_program({}, "G71") + "G14 J2\n";
  EXPECT_TRUE(has_error_of(smoothed(repeats, options_for("philips")), "word-means-other"));
}

}  // namespace
}  // namespace batten::postproc
