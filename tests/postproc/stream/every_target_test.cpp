// What holds for every target that writes lines and arcs: the written text is proved, fits the
// control, and a second pass leaves it alone.
#include <gtest/gtest.h>

#include <cmath>

#include "gcode/control/control.h"
#include "gcode/controls/arc_rules.h"
#include "gcode/controls/built_in.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

std::vector<std::string> target_names() {
  std::vector<std::string> names = {"linuxcnc"};
  for (const auto& family : {gcode::grbl_family(), gcode::printer_family(), gcode::pc_family(),
                             gcode::machining_center_family(), gcode::plc_family()}) {
    for (const gcode::Control& each : family) names.emplace_back(each.name);
  }
  return names;
}

// Controls without inches refuse G20; some say units as G70 and G71, one not at all.
std::string word_of_units(const gcode::Control& target, gcode::Units units) {
  const bool inch = units == gcode::Units::kInch;
  if (other_meaning(target, 210).empty()) {
    if (!other_meaning(target, 200).empty() && inch) return "";
    return inch ? "G20" : "G21";
  }
  return inch ? "G70" : "G71";
}

// A wave with one command in every block: some controls need it, the others take it.
std::string program(const Wave& wave, const std::string& units) {
  std::string full;
  for (const std::string& line : lines_of(wave_program(wave, units))) {
    full += (line.starts_with('X') ? "G1 " : "") + line + wave.line_end;
  }
  return full;
}

// The written lines that are not the program's own.
std::vector<std::string> new_lines(const std::string& before, const SmoothResult& result) {
  const auto old_lines = lines_of(before);
  std::vector<std::string> lines = lines_of(result.text);
  std::erase_if(lines, [&](const std::string& line) {
    return std::ranges::find(old_lines, line) != old_lines.end();
  });
  return lines;
}

class EveryTargetSmooths : public testing::TestWithParam<std::string> {
 protected:
  const gcode::Control& target_ = *gcode::find_control(GetParam());

  // Returns the new text.
  SmoothResult expect_smoothed(const std::string& text, SmoothOptions options) const {
    options.tolerance_mm = 0.02;
    SmoothResult result = smoothed(text, options);
    EXPECT_TRUE(result.understood);
    EXPECT_TRUE(result.proved);
    EXPECT_LE(result.deviation_mm, 0.02);
    if (options.output != Form::kArcs) {
      EXPECT_EQ(rewritten_runs(result), 1U) << result.runs.back().reason;
    }
    EXPECT_TRUE(verdict(text, result.text, 0.02).proved());
    expect_rest_copied(text, result);
    for (const std::string& line : lines_of(result.text)) {
      EXPECT_LE(line_length(target_, line), target_.max_line_length) << line;
    }
    for (const std::string& line : new_lines(text, result)) {
      if (!target_.repeats_words || line.starts_with(';') || line.starts_with('(')) continue;
      EXPECT_TRUE(line.starts_with('G')) << line;
    }
    return result;
  }
};

TEST_P(EveryTargetSmooths, AWaveInMillimetresProvedAndOnce) {
  const std::string text =
      program({.lines = 120, .noise = 0.003}, word_of_units(target_, gcode::Units::kMillimetre));
  for (const Form form : {Form::kAuto, Form::kLines, Form::kArcs}) {
    SmoothOptions options = options_for(GetParam());
    options.output = form;
    const SmoothResult result = expect_smoothed(text, options);
    if (form != Form::kAuto || comment_line(target_, "x").empty())
      continue;  // nothing says it there
    options.tolerance_mm = 0.02;
    EXPECT_EQ(smoothed(result.text, options).text, result.text) << "a second pass";
  }
}

TEST_P(EveryTargetSmooths, AWaveInInchesProved) {
  const std::string units = word_of_units(target_, gcode::Units::kInch);
  if (units.empty()) return;  // tested: Conversion refuses G20 there
  const Wave wave{.lines = 120,
                  .step = 0.008,
                  .height = 0.08,
                  .length = 0.7,
                  .noise = 0.0001,
                  .decimals = 4,
                  .feed = 80};
  SmoothOptions options = options_for(GetParam());
  options.prefer = Prefer::kSize;  // some targets print steps of the noise's own size
  (void)expect_smoothed(program(wave, units), options);
}

INSTANTIATE_TEST_SUITE_P(Targets, EveryTargetSmooths, testing::ValuesIn(target_names()),
                         [](const auto& test) { return test.param; });

SmoothResult smoothed_for(const gcode::Control& target, const std::string& text) {
  SmoothOptions options = options_for(target.name);
  options.target = &target;
  options.output = Form::kArcs;
  options.tolerance_mm = 0.02;
  return smoothed(text, options);
}

TEST(AProfile, ChangesWhatIsWritten) {
  gcode::Control mine = *gcode::find_control("haas");
  mine.arc_form = gcode::ArcForm::kRadius;
  mine.max_sweep_deg = 60;
  mine.trailing_zeros = true;
  mine.blanks = false;
  mine.comments = gcode::CommentStyle::kSemicolon;
  const std::string text = wave_program({.noise = 0.003});
  const SmoothResult result = smoothed_for(mine, text);
  ASSERT_EQ(rewritten_runs(result), 1U);
  EXPECT_TRUE(result.proved);
  auto lines = new_lines(text, result);
  const std::string comment = "; Batten: smoothed within 0.02 mm";
  ASSERT_TRUE(lines.front().ends_with(comment)) << lines.front();
  lines.front().resize(lines.front().size() - comment.size());
  std::size_t arcs = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i].find(' '), std::string::npos) << lines[i];
    EXPECT_EQ(lines[i].find_first_of("IJK"), std::string::npos) << lines[i];
    arcs += lines[i].find('R') != std::string::npos ? 1 : 0;
    const std::size_t x = lines[i].find('X');
    if (x == std::string::npos || i + 1 == lines.size()) continue;
    const std::size_t end = lines[i].find_first_not_of("-0123456789.", x + 1);
    const std::string number = lines[i].substr(x + 1, end == std::string::npos ? end : end - x - 1);
    EXPECT_EQ(number.size() - number.find('.') - 1, 3U) << lines[i];
  }
  EXPECT_GT(arcs, 3U);
}

// Radius 5, full circles as fine chords: parts of at most 90 degrees that end at the axes.
TEST(AProfile, SplitsArcsAtTheAxesOfThePlane) {
  std::string text = "G21 G90 G17\nG0 X5 Y0 Z5\nG1 Z-1 F300\n";
  for (int i = 1; i <= 360; ++i) {
    const double angle = i * 3.14159265358979 / 180;
    text += fmt::format("G1 X{:.4f} Y{:.4f} F1000\n", 5 * std::cos(angle), 5 * std::sin(angle));
  }
  text += "G0 Z5\nM30\n";
  gcode::Control mine = *gcode::find_control("haas");
  mine.single_quadrants = true;
  const SmoothResult result = smoothed_for(mine, text);
  ASSERT_EQ(rewritten_runs(result), 1U);
  EXPECT_TRUE(result.proved);
  const ReadText read(result.text);
  std::size_t arcs = 0;
  for (const gcode::Motion& motion : read.meaning.motions) {
    const auto* arc = motion.piece.arc();
    if (arc == nullptr) continue;
    ++arcs;
    const auto quadrant = [&](double t) {
      const geometry::Vector3 out = geometry::point_at(motion.piece, t) - arc->center;
      return static_cast<int>(std::floor(std::atan2(out.y(), out.x()) / 1.5707963267948966));
    };
    EXPECT_EQ(quadrant(0.02), quadrant(0.98));
  }
  EXPECT_GE(arcs, 4U);
}

TEST(AProfile, OfAControlThatCutsArcsCoarselyGetsMoreAndShorterMoves) {
  const std::string text = program({.noise = 0.003}, "G21");
  const gcode::Control& klipper = *gcode::find_control("klipper");
  const auto moves_for = [&text](const gcode::Control& target) {
    const ReadText read(smoothed_for(target, text).text);
    std::size_t arcs = 0;
    for (const gcode::Motion& motion : read.meaning.motions) {
      if (motion.piece.arc() == nullptr) continue;
      ++arcs;
      EXPECT_LE(gcode::chord_error(target.chords, *motion.piece.arc()), 0.02);
    }
    EXPECT_GT(arcs, 3U);
    return read.meaning.motions.size();
  };
  gcode::Control fine = klipper;
  fine.chords = {.longest = 0.1};  // resolution: 0.1
  // The wave's tightest bends have a radius of 4.1 mm: chords of 1 mm leave them by 0.03 mm, chords
  // of 0.1 mm by 0.0003 mm.
  EXPECT_GT(moves_for(klipper), moves_for(fine));
}

}  // namespace
}  // namespace batten::postproc
