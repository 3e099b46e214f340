// Programs that say how exact their parts have to be, smoothed and proved: each part within its own
// tolerance, measured here part by part without the verifier's sections.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "postproc/stream/part_verification.h"
#include "postproc/stream/pipeline.h"
#include "tests/support/in_windows.h"
#include "tests/support/klartext_programs.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

// mm: less than the finest tolerance here, so that the parts that have it are rewritten, too.
constexpr double kNoise = 0.003;

// The lines of a wave in order, with these in front of some of them.
struct WavePart {
  std::string before;
  int lines = 0;
};

std::string wave_in_parts(const std::vector<WavePart>& parts, const std::string& units = "G21") {
  Wave wave;
  wave.noise = kNoise;
  wave.lines = 0;
  for (const WavePart& part : parts) wave.lines += part.lines;
  const std::vector<std::string> lines = wave_lines(wave);
  std::string text = head(units);
  std::size_t next = 0;
  for (const WavePart& part : parts) {
    text += part.before;
    for (int i = 0; i < part.lines; ++i) text += lines[next++] + "\n";
  }
  return text + tail();
}

SmoothOptions options_within(double tolerance_mm) {
  SmoothOptions options = options_for("linuxcnc");
  options.method = Method::kFair;
  options.prefer = Prefer::kSize;  // which uses the tolerance up
  options.tolerance_mm = tolerance_mm;
  return options;
}

bool states_tolerance(const std::string& line) { return line.find("TOL") != std::string::npos; }

// Of each part between lines that say a tolerance the cuts of one program, as a path.
std::vector<geometry::Path> paths_of_parts(const std::string& text) {
  const ReadText read(text);
  const std::vector<std::string> lines = lines_of(text);
  std::vector<geometry::Path> paths(1);
  std::size_t line = 0;
  for (const gcode::Motion& motion : read.meaning.motions) {
    for (; line <= motion.block; ++line) {
      if (states_tolerance(lines[line])) paths.emplace_back();
    }
    if (motion.kind != gcode::MotionKind::kRapid) paths.back().push_back(motion.piece);
  }
  return paths;
}

// Where the same counts before and behind a line it may stand elsewhere on the new path.
void join_parts_of_one_limit(std::vector<geometry::Path>& paths,
                             const std::vector<double>& limits) {
  for (std::size_t i = 1; i < limits.size(); ++i) {
    if (limits[i] != limits[i - 1]) continue;
    paths[i].insert(paths[i].begin(), paths[i - 1].begin(), paths[i - 1].end());
    paths[i - 1].clear();
  }
}

// mm: an upper bound on how far each part of the new program is from that of the old one, where it
// is within `limits`, one for each part; infinite where it is not.
std::vector<double> distances(const std::string& before, const std::string& after,
                              const std::vector<double>& limits) {
  auto old_paths = paths_of_parts(before);
  auto new_paths = paths_of_parts(after);
  EXPECT_EQ(old_paths.size(), limits.size());
  EXPECT_EQ(new_paths.size(), limits.size());
  join_parts_of_one_limit(old_paths, limits);
  join_parts_of_one_limit(new_paths, limits);
  std::vector<double> found;
  for (std::size_t i = 0; i < limits.size(); ++i) {
    if (old_paths[i].empty() && new_paths[i].empty()) {
      found.push_back(0);
      continue;
    }
    const auto compared = geometry::compare_paths(old_paths[i], new_paths[i], limits[i]);
    found.push_back(compared.verdict == geometry::Verdict::kProved
                        ? compared.bounds.at_most
                        : std::numeric_limits<double>::infinity());
  }
  return found;
}

TEST(StatedTolerances, AreKeptByEachPartForItself) {
  const std::string text = wave_in_parts({{"", 120},
                                          {"(TOLERANCE 0.004)\n", 120},
                                          {"(TOLERANCE: 0.05)\n", 120},
                                          {"; TOL=0.008\n", 90}});
  const std::vector<double> limits = {0.02, 0.004, 0.02, 0.008};
  const SmoothResult result = smoothed(text, options_within(0.02));
  ASSERT_TRUE(result.proved);
  const std::vector<double> found = distances(text, result.text, limits);
  for (std::size_t i = 0; i < limits.size(); ++i) EXPECT_LE(found[i], limits[i]) << i;
  // Each part uses more than the next finer one may.
  EXPECT_GT(found[0], 0.008);
  EXPECT_GT(found[2], 0.008);
  EXPECT_GT(found[3], 0.004);
  EXPECT_GT(found[1], 0.001);
  // One tolerance for all: the finer parts are not kept.
  SmoothOptions one = options_within(0.02);
  one.one_tolerance = true;
  const SmoothResult other = smoothed(text, one);
  ASSERT_TRUE(other.proved);
  EXPECT_TRUE(other.stated.empty());
  EXPECT_GT(distances(text, other.text, limits)[1], limits[1]);
  EXPECT_FALSE(verdict(text, other.text, 0.02).proved());
}

TEST(StatedTolerances, AreReportedByTheirLinesAndRuns) {
  const std::string text =
      wave_in_parts({{"", 120}, {"(TOLERANCE 0.004)\n", 120}, {"(TOLERANCE: 0.05)\n", 120}});
  const SmoothResult result = smoothed(text, options_within(0.02));
  ASSERT_EQ(result.stated.size(), 2U);
  EXPECT_EQ(result.stated[0].line, 125U);
  EXPECT_EQ(result.stated[0].tolerance_mm, 0.004);
  EXPECT_EQ(result.stated[1].line, 246U);
  EXPECT_EQ(result.stated[1].tolerance_mm, 0.05);
  for (const RunReport& run : result.runs) {
    const bool fine = run.first_line > 125 && run.first_line < 246;
    EXPECT_EQ(run.tolerance_mm, fine ? 0.004 : 0.02) << run.first_line;
    EXPECT_LE(run.deviation_mm, run.tolerance_mm) << run.first_line;
  }
  EXPECT_EQ(rewritten_runs(result), 3U);
}

TEST(StatedTolerances, AreInInchesInAnInchProgram) {
  const std::string text = wave_in_parts({{"", 120}, {"(TOLERANCE 0.0002)\n", 120}}, "G20");
  const SmoothResult result = smoothed(text, options_within(0.02));
  ASSERT_TRUE(result.proved);
  ASSERT_EQ(result.stated.size(), 1U);
  EXPECT_DOUBLE_EQ(*result.stated[0].tolerance_mm, 0.00508);
}

// Before the first word of units: the line that says it, once, in those units.
TEST(StatedTolerances, BeforeTheUnitsAreReportedOnce) {
  const SmoothResult result =
      smoothed("(TOLERANCE 0.0002)\n" + wave_in_parts({{"", 60}}, "G20"), options_within(0.02));
  ASSERT_EQ(result.stated.size(), 1U);
  EXPECT_EQ(result.stated[0].line, 1U);
  EXPECT_DOUBLE_EQ(*result.stated[0].tolerance_mm, 0.00508);
}

TEST(StatedTolerances, LeaveASecondPassNothingToDo) {
  const std::string text = wave_in_parts({{"", 120}, {"(TOLERANCE 0.004)\n", 120}});
  const SmoothResult once = smoothed(text, options_within(0.02));
  ASSERT_EQ(rewritten_runs(once), 2U);
  EXPECT_EQ(smoothed(once.text, options_within(0.02)).text, once.text);
  EXPECT_EQ(smoothed(once.text, options_within(0.02)).stated.size(), 1U);
}

// Less than what four decimals can keep.
TEST(StatedTolerances, KeepThePartThatTheDecimalsCannotKeep) {
  const std::string text = wave_in_parts({{"", 120}, {"(TOLERANCE 0.00005)\n", 120}});
  const SmoothResult result = smoothed(text, options_within(0.02));
  ASSERT_TRUE(result.proved);
  ASSERT_EQ(rewritten_runs(result), 1U);
  const auto kept = std::ranges::find(result.runs, "stated-tolerance", &RunReport::reason);
  ASSERT_NE(kept, result.runs.end());
  EXPECT_EQ(kept->first_line, 126U);
  EXPECT_EQ(kept->tolerance_mm, 0.00005);
  expect_rest_copied(text, result);
}

TEST(StatedTolerances, OfRepeatedShapesAreOfEachByItself) {
  std::string text = "G21 G90 G17\n";
  for (const char* comment : {"", "(TOLERANCE 0.004)\n", "(TOLERANCE 0.05)\n"}) {
    Wave wave;
    wave.noise = kNoise;
    text += comment + std::string("G0 X0 Y0 Z5\nG1 Z-1 F300\n") + joined(wave_lines(wave), "\n") +
            "G0 Z5\n";
  }
  text += "M2\n";
  const SmoothResult result = smoothed(text, options_within(0.02));
  ASSERT_TRUE(result.proved);
  std::vector<const RunReport*> runs;
  for (const RunReport& run : result.runs) {
    if (run.status == RunStatus::kRewritten) runs.push_back(&run);
  }
  ASSERT_EQ(runs.size(), 3U);
  EXPECT_LE(runs[1]->deviation_mm, 0.004);
  EXPECT_GT(runs[0]->deviation_mm, 0.004);
  EXPECT_NEAR(runs[2]->deviation_mm, runs[0]->deviation_mm, 1e-6);
}

TEST(StatedTolerances, OfSiemensAndKlartextProgramsAreKept) {
  Wave wave;
  wave.noise = kNoise;
  const std::string lines = joined(wave_lines(wave), "\n");
  const std::string siemens =
      "G71 G90 G17 G64\nG0 X0 Y0 Z5\nCYCLE832(0.004,_FINISH,1)\nG1 Z-1 F300\n" + lines +
      "CYCLE832()\nG0 Z5\nM30\n";
  SmoothOptions options = options_for("siemens");
  options.tolerance_mm = 0.02;
  options.source = gcode::SourceKind::kSiemens;
  options.method = Method::kFair;
  options.prefer = Prefer::kSize;
  const SmoothResult result = smoothed(siemens, options);
  ASSERT_TRUE(result.proved);
  ASSERT_GE(rewritten_runs(result), 1U);
  EXPECT_LE(result.deviation_mm, 0.004);
  ASSERT_EQ(result.stated.size(), 2U);
  EXPECT_FALSE(result.stated[1].tolerance_mm);
  options.one_tolerance = true;
  EXPECT_GT(smoothed(siemens, options).deviation_mm, 0.004);

  std::vector<std::string> klartext = {"BEGIN PGM A MM",         "TOOL CALL 1 Z S5000",
                                       "CYCL DEF 32.0 TOLERANZ", "CYCL DEF 32.1 T0.004",
                                       "L X+0 Y+0 R0 FMAX M3",   "L Z-1 F300"};
  for (std::string line : wave_lines(wave)) {
    if (line.starts_with("G1 ")) line.erase(0, 3);
    line = "L " + line;
    klartext.push_back(line);
  }
  for (const char* line : {"L Z+50 FMAX", "M30", "END PGM A MM"}) klartext.emplace_back(line);
  SmoothOptions heidenhain = options_for("heidenhain");
  heidenhain.tolerance_mm = 0.02;
  heidenhain.method = Method::kFair;
  heidenhain.prefer = Prefer::kSize;
  const std::string text = tests::numbered_from_zero(klartext);
  const SmoothResult done = smoothed(text, heidenhain);
  ASSERT_TRUE(done.proved);
  ASSERT_GE(rewritten_runs(done), 1U);
  EXPECT_LE(done.deviation_mm, 0.004);
  heidenhain.one_tolerance = true;
  EXPECT_GT(smoothed(text, heidenhain).deviation_mm, 0.004);
}

// A converted program keeps the least of all of them.
TEST(StatedTolerances, OfAConvertedProgramAreKept) {
  const std::string text = wave_in_parts({{"", 120}, {"(TOLERANCE 0.006)\n", 120}});
  SmoothOptions options = options_for("heidenhain");
  options.tolerance_mm = 0.02;
  options.convert = true;
  options.method = Method::kFair;
  options.prefer = Prefer::kSize;
  options.allowed = {"work-offset", "tool-length"};
  const SmoothResult result = smoothed(text, options);
  ASSERT_TRUE(result.proved) << result.diagnostics.size();
  EXPECT_GE(rewritten_runs(result), 1U);
  EXPECT_LE(result.deviation_mm, 0.006);
  options.one_tolerance = true;
  EXPECT_GT(smoothed(text, options).deviation_mm, 0.006);
}

// Comments at random places of passes with rapids between them, and in the midst of passes.
class StatedSeed : public testing::TestWithParam<unsigned> {
 protected:
  StatedSeed() : random_(GetParam()) {
    text_ = "G21 G90 G17\nG0 X0 Y0 Z5\n";
    limits_ = {kUsers};
    for (int pass = 0; pass < 6; ++pass) add_pass();
    text_ += "M2\n";
  }

  void add_pass() {
    Wave wave;
    wave.noise = kNoise;
    wave.lines = 140;
    wave.seed = static_cast<unsigned>(random_());
    say_something();
    text_ += "G0 X0 Y0\nG1 Z-1 F300\n";
    const std::vector<std::string> lines = wave_lines(wave);
    const std::size_t middle = 30 + random_() % 80;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (i == middle) say_something();
      text_ += lines[i] + "\n";
    }
    text_ += "G0 Z5\n";
  }

  void say_something() {
    constexpr double kStated[] = {0.003, 0.006, 0.01, 0.02, 0.1};
    if (random_() % 3 == 0) return;
    const double stated = kStated[random_() % std::size(kStated)];
    text_ += fmt::format("(TOLERANCE {})\n", stated);
    limits_.push_back(std::min(kUsers, stated));
  }

  static constexpr double kUsers = 0.02;
  std::mt19937 random_;
  std::string text_;
  std::vector<double> limits_;
};

TEST_P(StatedSeed, KeepsInEachPartWhatTheProgramSays) {
  const SmoothResult result = smoothed(text_, options_within(kUsers));
  ASSERT_TRUE(result.proved);
  ASSERT_GT(rewritten_runs(result), 4U);
  const std::vector<double> found = distances(text_, result.text, limits_);
  for (std::size_t i = 0; i < limits_.size(); ++i) EXPECT_LE(found[i], limits_[i]) << i;
  EXPECT_TRUE(verdict(text_, result.text, kUsers).proved());
}

TEST_P(StatedSeed, ComesOutAsTheWholeInWindows) {
  SmoothOptions options = options_within(kUsers);
  options.share_work = false;
  const InWindows windows = in_windows(text_, options, 1);
  EXPECT_GT(windows.parts, 2U);
  expect_same(windows, as_a_whole(text_, options));
}

INSTANTIATE_TEST_SUITE_P(StatedTolerances, StatedSeed, testing::Range(0u, 8u));

// What keeps the tolerance of the user, and not that of a part, is refused: in parts and as a
// whole.
TEST(StatedTolerances, AreNotKeptByWhatOnlyKeepsThatOfTheUser) {
  std::string text = "G21 G90 G17\nG0 X0 Y0 Z5\n";
  for (const char* comment : {"(TOLERANCE 0.1)\n", "(TOLERANCE 0.003)\n", "(TOLERANCE 0.1)\n"}) {
    Wave wave;
    wave.noise = kNoise;
    wave.lines = 140;
    text += comment + std::string("G0 X0 Y0\nG1 Z-1 F300\n") + joined(wave_lines(wave), "\n") +
            "G0 Z5\n";
  }
  text += "M2\n";
  SmoothOptions one = options_within(0.02);
  one.one_tolerance = true;
  const gcode::SourceText before("old.nc", text);
  const gcode::SourceText after("new.nc", smoothed(text, one).text);
  for (const std::size_t least_text : {std::size_t{0}, std::size_t{1} << 30U}) {
    SCOPED_TRACE(least_text);
    const auto verified = [&](const PartReading& reading) {
      return verify_texts({before, reading}, {after, reading}, 0.02, {},
                          {.parts = {.blocks = 20, .least_text = least_text}})
          .value();
    };
    const VerifiedTexts whatever_it_says = verified({.options = {.stated_tolerances = false}});
    EXPECT_TRUE(whatever_it_says.verification.proved());
    EXPECT_EQ(whatever_it_says.as_whole, least_text > 0);
    const VerifiedTexts found = verified({});
    ASSERT_EQ(found.verification.violations.size(), 1U);
    EXPECT_EQ(found.verification.violations[0].id, "distance");
    EXPECT_GT(found.verification.violations[0].old_line, 146U);  // of the second pass
    EXPECT_LT(found.verification.violations[0].old_line, 290U);
  }
  // And what keeps it is proved in parts.
  const gcode::SourceText good("new.nc", smoothed(text, options_within(0.02)).text);
  const VerifiedTexts kept =
      verify_texts({before, {}}, {good, {}}, 0.02, {}, {.parts = {.blocks = 20, .least_text = 0}})
          .value();
  EXPECT_TRUE(kept.verification.proved());
  EXPECT_FALSE(kept.as_whole);
}

// A run of several windows: what is said before it and in the midst of it holds in all of them.
TEST(StatedTolerances, AreCarriedThroughTheWindowsOfALongRun) {
  const std::string text = wave_in_parts(
      {{"(TOLERANCE 0.005)\n", 900}, {"(TOLERANCE 0.05)\n", 900}, {"(TOL 0.008)\n", 700}});
  const LongRunLimits long_runs{.whole_at_most = 400, .shortest = 120, .longest = 240};
  const SmoothOptions options = options_within(0.02);
  const InWindows windows = in_windows(text, options, {.least_blocks = 50, .long_runs = long_runs});
  EXPECT_GT(windows.parts, 6U);
  EXPECT_EQ(windows.restarts, 0U);
  expect_same(windows, as_a_whole(text, options, long_runs));
  ASSERT_TRUE(windows.result.proved);
  const std::vector<double> limits = {0.02, 0.005, 0.02, 0.008};
  const std::vector<double> found = distances(text, windows.text, limits);
  for (std::size_t i = 0; i < limits.size(); ++i) EXPECT_LE(found[i], limits[i]) << i;
  EXPECT_GT(found[2], 0.008);
}

}  // namespace
}  // namespace batten::postproc
