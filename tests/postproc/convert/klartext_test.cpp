// What `smooth_program` promises of Heidenhain programs: proved on the written text, the same
// again, numbers that rise, and not a byte changed that is no run.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <tuple>

#include "gcode/writer/block_numbers.h"
#include "postproc/proof/verification.h"
#include "tests/support/klartext_programs.h"
#include "tests/support/places.h"
#include "tests/support/random_curves.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

using tests::klartext_program_of;
using tests::KlartextProgram;
using tests::numbered_from_zero;

SmoothOptions klartext_options(std::string_view target, Form output = Form::kAuto) {
  SmoothOptions options = options_for(std::string(target));
  options.output = output;
  return options;
}

// The numbers that lines begin with.
std::vector<int> numbers_of(const gcode::Program& program) {
  std::vector<int> numbers;
  for (const gcode::Block& block : program.blocks) {
    for (const gcode::Word& word : program.words_of(block)) {
      if (word.letter == 'N') numbers.push_back(static_cast<int>(word.value));
    }
  }
  return numbers;
}

void expect_rising(const std::string& text) {
  const std::vector<int> numbers = numbers_of(KlartextProgram(text).program);
  EXPECT_EQ(std::ranges::adjacent_find(numbers, std::greater_equal<>()), numbers.end()) << text;
}

Verification proof_of(const std::string& before, const std::string& after,
                      const SmoothOptions& options) {
  const KlartextProgram old_program(before, options.target->curves);
  const KlartextProgram new_program(after, options.target->curves);
  return verify({&old_program.program, &old_program.read},
                {&new_program.program, &new_program.read},
                {options.tolerance_mm, options.tolerance_kind, options.side});
}

// --- promises ---

void expect_promises(const std::string& before, const SmoothOptions& options,
                     const SmoothResult& result) {
  EXPECT_TRUE(result.understood);
  EXPECT_TRUE(result.proved);
  EXPECT_LE(result.deviation_mm, options.tolerance_mm);
  EXPECT_TRUE(proof_of(before, result.text, options).proved());
  expect_rising(result.text);
  EXPECT_EQ(smoothed(result.text, options).text, result.text);
}

TEST(Klartext, ProgramsOfRandomCurvesAreProved) {
  for (const Form form : {Form::kAuto, Form::kCurves}) {
    const SmoothOptions options =
        klartext_options(form == Form::kAuto ? "heidenhain" : "itnc530", form);
    std::size_t rewritten = 0;
    std::size_t with_splines = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
      SCOPED_TRACE(testing::Message() << "seed " << seed);
      const std::string before =
          numbered_from_zero(klartext_program_of(tests::random_curve(seed, seed % 2 == 1)));
      const SmoothResult result = smoothed(before, options);
      expect_promises(before, options, result);
      rewritten += rewritten_runs(result);
      with_splines += result.text.find("SPL") != std::string::npos ? 1 : 0;
    }
    EXPECT_GE(rewritten, 5U);
    EXPECT_TRUE(form == Form::kAuto ? with_splines == 0 : with_splines >= 5) << with_splines;
  }
}

// Splines need an option of the control.
TEST(Klartext, SplinesAreOnRequestOnly) {
  const std::string before = numbered_from_zero(klartext_program_of(tests::random_curve(3, false)));
  EXPECT_EQ(smoothed(before, klartext_options("itnc530")).text.find("SPL"), std::string::npos);
}

// Signs of the text are changed, lost and doubled: what is still read is proved, and nothing else
// is touched.
TEST(Klartext, DamagedProgramsAreProvedOrLeftAlone) {
  std::mt19937 random(11);
  const SmoothOptions options = klartext_options("heidenhain");
  const std::string sound = numbered_from_zero(klartext_program_of(tests::random_curve(4, false)));
  const std::string signs = "+-.,;~*/0189XYZLCRFM \n";
  for (int round = 0; round < 12; ++round) {
    std::string text = sound;
    for (int change = 0; change < 3; ++change) {
      const std::size_t at = random() % text.size();
      if (random() % 2 == 0) {
        text[at] = signs[random() % signs.size()];
      } else {
        text.erase(at, random() % 9);
      }
    }
    const SmoothResult result = smoothed(text, options);
    if (!result.understood) continue;
    EXPECT_TRUE(result.proved) << text;
    EXPECT_TRUE(rewritten_runs(result) > 0 || result.text == text);
  }
}

// --- byte for byte ---

std::string case_text(const std::string& name) {
  const std::string text =
      text_of_file(std::string(BATTEN_SOURCE_DIR) + "/tests/cases/heidenhain/" + name);
  EXPECT_FALSE(text.empty()) << name;
  return text;
}

// Texts as they were written once, against their source: what was proved then is proved now.
TEST(Klartext, WrittenCasesAreProved) {
  const std::string before = case_text("pocket.h");
  for (const char* name : {"pocket.arcs.h", "pocket.spl.h"}) {
    const std::string after = case_text(name);
    EXPECT_TRUE(proof_of(before, after, klartext_options("itnc530")).proved()) << name;
    expect_rising(after);
  }
}

TEST(Klartext, BothRunsOfAPocketAreRewritten) {
  const std::string before = case_text("pocket.h");
  for (const auto& [target, form, wanted] : {std::tuple("heidenhain", Form::kArcs, Form::kArcs),
                                             std::tuple("itnc530", Form::kCurves, Form::kCurves)}) {
    const SmoothOptions options = klartext_options(target, form);
    const SmoothResult result = smoothed(before, options);
    expect_promises(before, options, result);
    EXPECT_EQ(rewritten_runs(result), 2U);
    EXPECT_LT(2 * result.blocks_out, result.blocks_in);
    for (const RunReport& run : result.runs) {
      if (run.status == RunStatus::kRewritten) {
        EXPECT_EQ(run.form, wanted);
      }
    }
    for (const char* kept :
         {"\n3 ; POCKET WITH A WAVY WALL\n4 * - FINISH\n5 CYCL DEF 32.0 TOLERANCE\n",
          "; HALF WAY\n", "\n  Q200=+2 ;SET-UP CLEARANCE ~\n",
          "440 CC X+0 Y-30\n441 C X+0 Y-40 DR+\n442 L Z+50 R0 FMAX M9\n"}) {
      EXPECT_NE(result.text.find(kept), std::string::npos) << kept;
    }
  }
}

TEST(Klartext, EveryOtherConstructIsCopied) {
  const std::string before = case_text("constructs.h");
  for (const std::string_view target : {"heidenhain", "itnc530"}) {
    const SmoothResult result = smoothed(before, klartext_options(target));
    EXPECT_TRUE(result.understood);
    EXPECT_EQ(result.text, before) << target;
  }
}

// Lines before and behind a wave that would be a run without them.
struct KeptWave {
  std::string name;
  std::vector<std::string> before;
  std::vector<std::string> behind = {};
};

std::string wave_in(const KeptWave& test) {
  std::vector<std::string> lines = klartext_program_of(tests::random_curve(4, false));
  lines.insert(lines.begin() + 4, test.before.begin(), test.before.end());
  lines.insert(lines.end() - 3, test.behind.begin(), test.behind.end());
  return numbered_from_zero(lines);
}

TEST(Klartext, WavesInASafeStateAreRewritten) {
  const SmoothOptions options = klartext_options("heidenhain");
  for (const KeptWave& safe :
       {KeptWave{"Nothing", {}}, KeptWave{"Tolerance", {"CYCL DEF 32.0 T", "CYCL DEF 32.1 T0.02"}},
        KeptWave{"PlaneReset", {"PLANE SPATIAL SPA+0 SPB+9 SPC+0 TURN", "PLANE RESET TURN"}},
        KeptWave{"Preset", {"CYCL DEF 247 PRESET ~", "  Q339=+1"}}}) {
    EXPECT_GE(rewritten_runs(smoothed(wave_in(safe), options)), 1U) << safe.name;
  }
}

TEST(Klartext, WavesInOtherStatesAreKept) {
  const KeptWave kKept[] = {{"TiltedPlane", {"PLANE SPATIAL SPA+0 SPB+45 SPC+0 STAY"}},
                            {"Cycle19", {"CYCL DEF 19.0 W", "CYCL DEF 19.1 A+0 B+5 C+0"}},
                            {"TiltedTool", {"M128"}},
                            {"Tcpm", {"FUNCTION TCPM F TCP"}},
                            {"Mirror", {"CYCL DEF 8.0 M", "CYCL DEF 8.1 X"}},
                            {"Rotation", {"CYCL DEF 10.0 R", "CYCL DEF 10.1 ROT+30"}},
                            {"Scaling", {"CYCL DEF 11.0 S", "CYCL DEF 11.1 SCL 0.5"}},
                            {"ScalingByAxis", {"CYCL DEF 26.0 S", "CYCL DEF 26.1 X0.5 Y1"}},
                            {"CycleAtEachPlace", {"CYCL CALL M89"}},
                            {"PointFilter", {"M124 T0.01"}},
                            {"FeedPerTurn", {"M136"}},
                            {"AfterACall", {"CALL LBL 9"}},
                            {"AfterAProgram", {"CALL PGM OTHER"}},
                            {"AfterAnUnknownCycle", {"CYCL DEF 491"}},
                            {"AfterSomethingUnknown", {"WHATEVER"}},
                            {"InABody", {"LBL 1"}, {"LBL 0", "CALL LBL 1"}},
                            {"Repeated", {"LBL 1"}, {"CALL LBL 1 REP 5"}}};
  for (const KeptWave& kept : kKept) {
    const std::string before = wave_in(kept);
    EXPECT_EQ(smoothed(before, klartext_options("heidenhain")).text, before) << kept.name;
    EXPECT_EQ(smoothed(before, klartext_options("itnc530", Form::kCurves)).text, before)
        << kept.name;
  }
}

// --- what is written ---

std::vector<std::string> circle_chords(double from, double to, int count) {
  std::vector<std::string> lines;
  for (int i = 1; i <= count; ++i) {
    const double angle = (from + (to - from) * i / count) * std::numbers::pi / 180;
    lines.push_back(fmt::format("L X{:+.3f} Y{:+.3f}", 30 * std::cos(angle), 30 * std::sin(angle)));
  }
  return lines;
}

std::vector<std::string> circle_program() {
  std::vector<std::string> lines = {"BEGIN PGM C MM", "TOOL CALL 3 Z S12000",
                                    "L X+30 Y+0 Z+5 R0 FMAX M3", "L Z-1 F1000"};
  for (const std::string& line : circle_chords(0, 150, 60)) lines.push_back(line);
  for (const char* line : {"L Z+50 FMAX", "END PGM C MM"}) lines.push_back(line);
  return lines;
}

TEST(Klartext, ChordsOfACircleBecomeArcsAboutItsCentre) {
  const SmoothOptions options = klartext_options("heidenhain", Form::kArcs);
  const std::string before = numbered_from_zero(circle_program(), "\r\n");
  const SmoothResult result = smoothed(before, options);
  ASSERT_EQ(rewritten_runs(result), 1U) << result.text;
  const std::size_t first = result.text.find("\r\n4 CC X");
  ASSERT_NE(first, std::string::npos) << result.text;
  const std::size_t said = result.text.find(" ; Batten: smoothed within 0.01 mm\r\n5 C X");
  EXPECT_EQ(said, result.text.find(" ;", first)) << result.text;
  EXPECT_NE(result.text.find("DR+"), std::string::npos);
  EXPECT_EQ(result.text.find("DR-"), std::string::npos);
  expect_promises(before, options, result);
}

// Without numbers none are added.
TEST(Klartext, ProgramsWithoutNumbersStaySo) {
  std::string before;
  for (const std::string& line : circle_program()) before += line + "\n";
  const SmoothOptions options = klartext_options("heidenhain");
  const SmoothResult result = smoothed(before, options);
  EXPECT_EQ(rewritten_runs(result), 1U);
  EXPECT_NE(result.text.find(" ; Batten: smoothed within 0.01 mm\n"), std::string::npos);
  EXPECT_TRUE(numbers_of(KlartextProgram(result.text).program).empty());
  EXPECT_TRUE(proof_of(before, result.text, options).proved());
}

// A later arc about the centre of the program's own CC, which a new CC would have moved.
TEST(Klartext, LaterArcsKeepTheirCentre) {
  std::vector<std::string> lines = circle_program();
  lines.insert(lines.begin() + 3, "CC X+0 Y+0");
  lines.insert(lines.end() - 2, "C X+30 Y+0 DR-");
  lines.insert(lines.end() - 2, "LP PR+40 PA+10 M8");
  const std::string before = numbered_from_zero(lines);
  const SmoothOptions options = klartext_options("heidenhain", Form::kArcs);
  const SmoothResult result = smoothed(before, options);
  EXPECT_TRUE(result.proved);
  EXPECT_TRUE(proof_of(before, result.text, options).proved());
  // The same text with another CC before the last blocks is no proof.
  std::string moved = before;
  const std::size_t at = moved.find("C X+30 Y+0 DR-");
  moved.insert(moved.rfind('\n', at) + 1, "63 CC X+1 Y+0\n");
  EXPECT_FALSE(proof_of(before, moved, options).proved());
}

// --- what a proof must find ---

TEST(Klartext, DamageIsFound) {
  constexpr std::array<std::string_view, 2> kOfThePocket[] = {
      {"DR+", "DR-"},
      {"CC X+", "CC X+1"},
      {" R0 FMAX M3", " R0 M3"},
      {"TOOL CALL 3", "TOOL CALL 4"},
      {"BEGIN PGM POCKET MM", "BEGIN PGM POCKET INCH"},
      {"M8", "M9"},
      {"T0.02", "T0.2"},  // of a cycle
      {"F3000", "F3100"}};
  const std::string before = case_text("pocket.arcs.h");
  const SmoothOptions options = klartext_options("heidenhain");
  EXPECT_TRUE(proof_of(before, before, options).proved());
  for (const auto& [was, is] : kOfThePocket) {
    EXPECT_FALSE(proof_of(before, replaced(before, was, is), options).proved()) << was;
  }
}

// Numbers alone are made anew by the control.
TEST(Klartext, OtherBlockNumbersAreNoDifference) {
  const std::string before = case_text("pocket.h");
  EXPECT_TRUE(proof_of(before, with_numbers(before, 100), klartext_options("heidenhain")).proved());
}

TEST(Klartext, RunsThatNeedMoreNumbersThanThereAreGoBack) {
  std::vector<std::string> lines = circle_program();
  std::string before;
  // All blocks of the run have the same number, so there is room for one.
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t number = i < 4 ? i : i + 2 < lines.size() ? 4 : i + 5 - lines.size() + 2;
    before += std::to_string(number) + " " + lines[i] + "\n";
  }
  EXPECT_EQ(smoothed(before, klartext_options("heidenhain")).text, before);
}

}  // namespace
}  // namespace batten::postproc
