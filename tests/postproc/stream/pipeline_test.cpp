// What `smooth_program` promises of every text: proved, the same again, and nothing touched that
// is no run.
#include "postproc/stream/pipeline.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "gcode/state/reason.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

bool has_diagnostic(const SmoothResult& result, std::string_view id) {
  return std::ranges::any_of(result.diagnostics,
                             [id](const gcode::Diagnostic& d) { return d.id == id; });
}

TEST(Pipeline, KeepsEveryByteWhereNothingIsToBeRewritten) {
  const std::pair<const char*, std::string> rows[] = {
      {"nothing", ""},
      {"no motion", "G21 G90\nM2\n"},
      {"no line end at the end", "G21 G90\nG0 X1\nG1 X2 F100\nM2"},
      {"mixed line ends and blanks", "  G21\tG90 \r\n\n\r\nG0 X1  \nG1X2F100\r\nM2\r\n"},
      {"bytes that are not ASCII", "(Fr\xE4ser \xC3\xA4)\nG21 G90\nG0 X1\nM2\n"},
      {"straight lines", head("G21") + "G1 X10 F500\nX20 Y10\nX50 Y30\nX20 Y70\n" + tail()},
      {"arcs", head("G21") + "G2 X10 Y0 I5 J0 F500\nG3 X20 I5\nG2 X30 I5\n" + tail()}};
  for (const auto& [name, text] : rows) {
    SCOPED_TRACE(name);
    const SmoothResult result = smoothed(text, options_for("linuxcnc"));
    EXPECT_TRUE(result.understood);
    EXPECT_TRUE(result.text == text) << result.text;
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(rewritten_runs(result), 0u);
    EXPECT_EQ(result.blocks_out, result.blocks_in);
    EXPECT_EQ(result.deviation_mm, 0);
  }
}

// Four decimals move a place by up to 0.000087 mm in space, so 0.00005 mm cannot be kept.
TEST(Pipeline, KeepsEveryByteWithMethodNoneAndWhereRoundingAloneUsesUpTheTolerance) {
  SmoothOptions none = options_for("linuxcnc");
  none.method = Method::kNone;
  SmoothOptions narrow = options_for("linuxcnc");
  narrow.tolerance_mm = 0.00005;
  for (const auto& [options, reason] :
       {std::pair(none, gcode::reason::kMethodNone), std::pair(narrow, gcode::reason::kNoFit)}) {
    const SmoothResult result = smoothed(wave_program(), options);
    EXPECT_EQ(result.text, wave_program());
    EXPECT_TRUE(result.proved);
    EXPECT_EQ(result.runs.back().reason, reason);
  }
}

TEST(Pipeline, UnderstandsNothingWithoutUnitsOrOfAnotherLanguage) {
  const std::string text = wave_program({}, "G94");
  for (const std::string& each :
       {text, std::string("0 BEGIN PGM X MM\n1 L X+10 Y+5 F500\n2 END PGM X MM\n")}) {
    const SmoothResult result = smoothed(each, options_for("linuxcnc"));
    EXPECT_FALSE(result.understood);
    EXPECT_EQ(has_diagnostic(result, "units-missing"), each == text);
    EXPECT_TRUE(gcode::has_error(result.diagnostics));
    EXPECT_EQ(result.text, "");
  }
  SmoothOptions told = options_for("linuxcnc");
  told.units = gcode::Units::kMillimetre;
  EXPECT_TRUE(smoothed(text, told).understood);
}

TEST(Pipeline, StopsWhenTheProgressSaysSo) {
  for (int stop_at = 1; stop_at <= 3; ++stop_at) {
    int calls = 0;
    const SmoothResult result = smoothed(wave_program(), options_for("linuxcnc"), [&](double) {
      ++calls;
      return calls < stop_at;
    });
    EXPECT_EQ(calls, stop_at) << "no call after the one that said stop";
    EXPECT_FALSE(result.understood);
    EXPECT_EQ(result.text, "");
  }
}

TEST(Pipeline, TellsProgressThatNeverGoesBack) {
  std::vector<double> parts;
  const SmoothResult result = smoothed(wave_program(), options_for("linuxcnc"), [&](double part) {
    parts.push_back(part);
    return true;
  });
  EXPECT_TRUE(result.understood);
  ASSERT_GE(parts.size(), 2u);
  EXPECT_TRUE(std::ranges::is_sorted(parts));
  EXPECT_GE(parts.front(), 0);
  EXPECT_LE(parts.back(), 1);
}

TEST(Pipeline, RewritesAWave) {
  const SmoothResult result = smoothed(wave_program(), options_for("linuxcnc"));
  ASSERT_EQ(rewritten_runs(result), 1u);
  const auto run = std::ranges::find(result.runs, RunStatus::kRewritten, &RunReport::status);
  EXPECT_EQ(run->first_line, 5u);
  EXPECT_EQ(run->last_line, 204u);
  EXPECT_EQ(run->points, 201u);
  EXPECT_EQ(run->blocks_in, 200u);
  EXPECT_EQ(run->method, "fair");
  EXPECT_TRUE(run->proved);
  EXPECT_GT(run->deviation_mm, 0);
  EXPECT_LE(run->deviation_mm, 0.01);
  EXPECT_EQ(result.deviation_mm, run->deviation_mm);
  expect_rest_copied(wave_program(), result);
}

TEST(Pipeline, KeepsLineEnds) {
  Wave wave;
  wave.line_end = "\r\n";
  const SmoothResult result = smoothed(wave_program(wave), options_for("linuxcnc"));
  ASSERT_EQ(rewritten_runs(result), 1u);
  for (std::size_t i = 0; i < result.text.size(); ++i) {
    if (result.text[i] != '\n') continue;
    ASSERT_GT(i, 0u);
    ASSERT_EQ(result.text[i - 1], '\r') << "byte " << i;
  }
  expect_rest_copied(wave_program(wave), result);
}

// X grows along the wave, so the X words around a comment tell where it stands.
TEST(Pipeline, KeepsCommentsAtTheirPlace) {
  std::vector<std::string> lines = wave_lines({});
  lines[59] += " (first)";                        // leads to X12
  lines.insert(lines.begin() + 140, "(second)");  // between X28 and X28.2
  const std::string text = head("G21") + joined(lines, "\n") + tail();
  const SmoothResult result = smoothed(text, options_for("linuxcnc"));
  ASSERT_EQ(rewritten_runs(result), 1u);
  const ReadText read(result.text);
  for (const auto& [comment, x] :
       std::vector<std::pair<std::string, double>>{{"(first)", 12.0}, {"(second)", 28.1}}) {
    const std::size_t at = result.text.find(comment);
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(result.text.find(comment, at + 1), std::string::npos) << "twice";
    const gcode::Motion* before = nullptr;
    const gcode::Motion* behind = nullptr;
    for (const gcode::Motion& motion : read.meaning.motions) {
      if (read.program.blocks[motion.block].span.begin < at)
        before = &motion;
      else if (behind == nullptr)
        behind = &motion;
    }
    ASSERT_TRUE(before != nullptr && behind != nullptr);
    // Within the moves on either side of it.
    EXPECT_LE(geometry::start_point(before->piece).x(), x + 0.001) << comment;
    EXPECT_GE(geometry::end_point(behind->piece).x(), x - 0.001) << comment;
  }
}

// Engraving programs say at each block what it is for.
TEST(Pipeline, WritesNoMoreLinesWhereACommentIsBehindEachMove) {
  std::vector<std::string> lines = wave_lines({.height = 3, .noise = 0.004});
  for (std::string& line : lines) line += " (lineto)";
  const std::string text = head("G21") + joined(lines, "\n") + tail();
  const auto newlines = [](const std::string& of) { return std::ranges::count(of, '\n'); };
  for (const Form form : {Form::kAuto, Form::kArcs, Form::kLines}) {
    SmoothOptions options = options_for("linuxcnc");
    options.output = form;
    const SmoothResult result = smoothed(text, options);
    EXPECT_EQ(rewritten_runs(result), 1U);
    // The comment that says what was done, and a block that restores G1 behind arcs.
    EXPECT_LE(newlines(result.text), newlines(text) + (form == Form::kArcs ? 2 : 1));
  }
}

TEST(Pipeline, KeepsFeedsInTheirOrderAndAtTheirPlaces) {
  std::vector<std::string> lines = wave_lines({});
  lines[80] += " F1000";
  lines[120] += " F1500";
  const std::string text = head("G21") + joined(lines, "\n") + tail();
  const SmoothResult result = smoothed(text, options_for("grbl"));
  ASSERT_EQ(rewritten_runs(result), 1u);
  EXPECT_TRUE(verdict(text, result.text, 0.01).proved());
  std::vector<std::string> feeds;
  for (const std::string& line : lines_of(result.text)) {
    const std::size_t at = line.find('F');
    if (at != std::string::npos) feeds.push_back(line.substr(at, line.find_first_of(" \n", at) - at));
  }
  EXPECT_EQ(feeds, (std::vector<std::string>{"F300", "F2000", "F1000", "F1500"}));
}

TEST(Pipeline, KeepsLabelsThatAreReferredTo) {
  std::vector<std::string> lines = wave_lines({});
  lines[100] = "N50 " + lines[100];
  const std::string text = head("G21") + joined(lines, "\n") + "G0 Z5\nM5\nGOTO 50\nM2\n";
  const SmoothResult result = smoothed(text, options_for("haas"));  // LinuxCNC has no GOTO
  EXPECT_NE(result.text.find(lines[100] + "\n"), std::string::npos) << "label and block together";
  EXPECT_TRUE(result.proved);
  EXPECT_TRUE(verdict(text, result.text, 0.01).proved());
}

TEST(Pipeline, KeepsPlunges) {
  const std::vector<std::string> lines = wave_lines({});
  const std::vector<std::string> first(lines.begin(), lines.begin() + 100);
  const std::vector<std::string> second(lines.begin() + 100, lines.end());
  const std::string text =
      head("G21") + joined(first, "\n") + "Z-2.5\n" + joined(second, "\n") + tail();
  const SmoothResult result = smoothed(text, options_for("linuxcnc"));
  EXPECT_EQ(rewritten_runs(result), 2u);
  EXPECT_NE(result.text.find("\nG1 Z-1 F300\n"), std::string::npos);
  EXPECT_NE(result.text.find("\nZ-2.5\n"), std::string::npos);
  expect_rest_copied(text, result);
}

// 1.6 inches of wave with 0.08 inches of height.
TEST(Pipeline, LeavesAnInchProgramInInches) {
  const Wave wave{.step = 0.008, .height = 0.08, .length = 0.7, .decimals = 4, .feed = 80};
  const std::string text = wave_program(wave, "G20");
  const SmoothResult result = smoothed(text, options_for("linuxcnc"));
  ASSERT_EQ(rewritten_runs(result), 1u);
  EXPECT_EQ(result.units, gcode::Units::kInch);
  EXPECT_EQ(result.text.find("G21"), std::string::npos);
  EXPECT_TRUE(verdict(text, result.text, 0.01).proved());
  const auto run = std::ranges::find(result.runs, RunStatus::kRewritten, &RunReport::status);
  EXPECT_LE(run->deviation_mm, 0.01);
  EXPECT_GT(run->deviation_mm, 0.0001) << "in mm";
}

// The copied block after the run has no G word and no F word: it must still be a line at F2000.
TEST(Pipeline, RestoresTheStateAfterARun) {
  const std::string after = "X60 Y7 M8\n";
  const std::string text = head("G21") + joined(wave_lines({}), "\n") + after + tail();
  for (const Form form : {Form::kArcs, Form::kLines}) {
    SmoothOptions options = options_for("linuxcnc");
    options.output = form;
    const SmoothResult result = smoothed(text, options);
    ASSERT_EQ(rewritten_runs(result), 1u) << name_of(form);
    EXPECT_EQ(result.text.find("G2 ") != std::string::npos, form == Form::kArcs);
    const ReadText read(result.text);
    const std::size_t at = result.text.find(after);
    ASSERT_NE(at, std::string::npos);
    const auto motion = std::ranges::find_if(read.meaning.motions, [&](const gcode::Motion& m) {
      return read.program.blocks[m.block].span.begin == at;
    });
    ASSERT_NE(motion, read.meaning.motions.end());
    EXPECT_EQ(motion->kind, gcode::MotionKind::kLine) << name_of(form);
    EXPECT_EQ(read.meaning.states[read.meaning.blocks[motion->block].state_after].feed, 2000)
        << name_of(form);
  }
}

// grbl keeps 80 bytes of a line, the last one is a zero.
TEST(Pipeline, WritesShortLinesForGrbl) {
  std::string text = "G21 G90 G17\nG0 X-1000 Y-1000 Z5\nG1 Z-100.123 F300\n";
  for (int i = 1; i <= 200; ++i) {
    text += fmt::format(
        "G1 X{:.3f} Y{:.3f} Z{:.3f} F12345.678 (a rather long comment of this block "
        "that would not fit)\n",
        -1000 - 0.2 * i, -1000 - 2 * std::sin(0.07 * i), -100.123 - 0.01 * i);
  }
  text += tail();
  for (const Form form : {Form::kAuto, Form::kArcs, Form::kLines}) {
    SmoothOptions options = options_for("grbl");
    options.output = form;
    const std::string plain = wave_program();
    for (const std::string& program : {text, plain}) {
      const SmoothResult result = smoothed(program, options);
      EXPECT_TRUE(result.proved);
      std::vector<std::string> old_lines = lines_of(program);
      for (const std::string& line : lines_of(result.text)) {
        const bool copied = std::ranges::find(old_lines, line) != old_lines.end();
        EXPECT_TRUE(line_length(*options.target, line) <= 79 || copied) << line;
      }
    }
  }
}

TEST(Pipeline, SmoothsNoProgramTwiceUnlessAllowed) {
  const std::string text = "(Batten: smoothed within 0.01 mm)\n" + wave_program();
  SmoothOptions options = options_for("linuxcnc");
  const SmoothResult kept = smoothed(text, options);
  EXPECT_EQ(kept.text, text);
  EXPECT_TRUE(kept.proved);
  EXPECT_EQ(std::ranges::count(kept.runs, gcode::reason::kAlreadySmoothed, &RunReport::reason), 1);
  options.allowed = {"already-smoothed"};
  const SmoothResult again = smoothed(text, options);
  EXPECT_EQ(rewritten_runs(again), 1u);
  EXPECT_TRUE(again.proved);
}

TEST(Pipeline, SaysOnceThatAProgramWasSmoothed) {
  const std::string text = wave_program();
  const std::string two_runs = text.substr(0, text.find("M5")) + "G0 X0 Y0\nG1 Z-2 F300\n" +
                               joined(wave_lines({}), "\n") + tail();
  const SmoothResult result = smoothed(two_runs, options_for("linuxcnc"));
  EXPECT_EQ(rewritten_runs(result), 2u);
  const std::size_t at = result.text.find("Batten: smoothed within 0.01 mm");
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(result.text.find("Batten", at + 1), std::string::npos);
}

// Behind the words of the first new block, so that the program has no block more for it; on a line of
// its own where there is no room for that.
TEST(Pipeline, SaysBehindABlockThatAProgramWasSmoothed) {
  const std::string said = "(Batten: smoothed within 0.01 mm)";
  const std::string text = wave_program();
  const SmoothResult result = smoothed(text, options_for("linuxcnc"));
  const std::size_t at = result.text.find(said);
  ASSERT_NE(at, std::string::npos);
  const std::size_t line = result.text.rfind('\n', at) + 1;
  EXPECT_NE(result.text[line], '(');
  EXPECT_EQ(result.text[at + said.size()], '\n');
  gcode::Control narrow = *gcode::find_control("linuxcnc");
  narrow.max_line_length = 60;
  SmoothOptions options = options_for("linuxcnc");
  options.target = &narrow;
  const SmoothResult apart = smoothed(text, options);
  EXPECT_NE(apart.text.find("\n" + said + "\n"), std::string::npos);
  EXPECT_EQ(apart.blocks_out, result.blocks_out + 1);
}

// LinuxCNC forgets the feed there, and stops at a curve without one.
TEST(Pipeline, SaysTheFeedAgainBehindAFeedMode) {
  const std::string head = "G21 G90 G17 G94\nG0 X0 Y0 Z0\nG1 X0 Y0 F2000\nG94\n";
  const std::string text = head + joined(wave_lines({.lines = 60}), "\n") + "M2\n";
  const SmoothResult result = smoothed(text, options_for("linuxcnc"));
  ASSERT_GE(rewritten_runs(result), 1U);
  const std::size_t behind = result.text.find("G94\n", result.text.find("F2000"));
  ASSERT_NE(behind, std::string::npos);
  const std::size_t cut = result.text.find('X', behind);
  const std::string first = result.text.substr(cut, result.text.find('\n', cut) - cut);
  EXPECT_NE(first.find("F2000"), std::string::npos) << result.text;
}

}  // namespace
}  // namespace batten::postproc
