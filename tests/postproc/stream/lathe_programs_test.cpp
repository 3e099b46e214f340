// Programs for lathes: X may be a diameter there and G90 a cycle, so they are copied byte for byte,
// for a reason and with a warning that names the mark. Programs for mills that look alike are
// smoothed.
#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>

#include "postproc/machine/program_time/program_time_steps.h"
#include "postproc/report/smooth_report.h"
#include "tests/support/constructs.h"
#include "tests/support/in_windows.h"
#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

const gcode::Diagnostic* lathe_warning(const SmoothResult& result) {
  const auto found = std::ranges::find(result.diagnostics, std::string_view("lathe-program"),
                                       &gcode::Diagnostic::id);
  return found == result.diagnostics.end() ? nullptr : &*found;
}

// Siemens programs are read as such.
SmoothOptions options_of(std::string_view target) {
  SmoothOptions options = options_for(target);
  if (target == "siemens") options.source = gcode::SourceKind::kSiemens;
  return options;
}

std::string in_x_and_z(const Wave& wave) {
  std::string text = joined(wave_lines(wave), "\n");
  std::ranges::replace(text, 'Y', 'Z');
  return text;
}

// A contour in X and Z that any mill would cut, and that has no mark of a lathe.
std::string contour(const std::string& head, const std::string& tail = "") {
  std::string text = head + "G0 X40. Z5.\nG1 Z0. F200.\n";
  text += in_x_and_z({.decimals = 4});
  return text + tail + "G0 X100.\nM30\n";
}

void expect_copied(const std::string& text, std::string_view target, std::string_view evidence) {
  const SmoothResult result = smoothed(text, options_of(target));
  EXPECT_TRUE(result.understood);
  EXPECT_TRUE(result.proved);
  EXPECT_EQ(result.text, text);
  for (const RunReport& run : result.runs) EXPECT_EQ(run.reason, "lathe-program");
  const gcode::Diagnostic* warning = lathe_warning(result);
  ASSERT_NE(warning, nullptr);
  EXPECT_EQ(warning->severity, gcode::Severity::kWarning);
  EXPECT_TRUE(warning->message.starts_with(evidence)) << warning->message;
}

TEST(LatheProgram, KeepsEachPassOfATurningCycleAndNeedsNoUnits) {
  expect_copied("T0101\nG50 S2000\nG0 X40. Z2.\nG90 X38. Z-20. F0.2\nX36.\nM30\n", "fanuc", "");
  // Read as a mill's program these are moves along X in one line, one of which would be enough.
  const std::string lathe_passes =
      "G0 X62. Z2.\nG1 X60. F0.3\nG90 X58. Z-40. F0.25\nX54.\nX50.\nX46.\nX42.\nX38.\n"
      "G0 X100. Z100.\nM30\n";
  expect_copied("G21\nT0101\nM3 S800\n" + lathe_passes, "fanuc", "T with the number of an offset");
  expect_copied("G21\nG50 S2000\nG97 S800 M3\n" + lathe_passes, "fanuc", "G50 S, a limit");
  expect_copied("G21\nM3 S800\n" + lathe_passes, "haas",
                "a feed that only one per revolution can be");
}

struct MarkCase {
  std::string name;
  std::string target;
  std::string lines;
  std::string evidence;
  bool certain = true;  // also where Y is named
};
void PrintTo(const MarkCase& c, std::ostream* out) { *out << c.name; }

std::vector<MarkCase> marks_in(const char* table, bool certain) {
  std::vector<MarkCase> cases;
  for (const Construct& row : constructs_in(table)) {
    cases.push_back({row.name, row.target, row.text, row.reason, certain});
  }
  return cases;
}

std::string name_of_mark(const testing::TestParamInfo<MarkCase>& test) {
  return test.param.target + test.param.name;
}

class Mark : public testing::TestWithParam<MarkCase> {};

TEST_P(Mark, CopiesTheProgramHoweverLateAndWhereYIsNamedOnlyIfItIsCertain) {
  const MarkCase& c = GetParam();
  expect_copied(contour("G21 G40\n" + c.lines + "\n"), c.target, c.evidence);
  expect_copied(contour("G21 G40\n", c.lines + "\n"), c.target, c.evidence);
  const SmoothResult result =
      smoothed(contour("G21 G40\n" + c.lines + "\nG0 Y5.\n"), options_of(c.target));
  EXPECT_EQ(lathe_warning(result) != nullptr, c.certain);
}

// Name | control | lines before the contour | how the warning begins. Certain ones are marks also
// where Y is named.
constexpr const char* kCertain = R"(
SpindleLimit|fanuc|G50 S2000|G50 S
SpindleLimitWithTool|haas|N1 G50 S2000 T0101|G50 S
SpindleLimitAndOrigin|fanuc|G50 X200. Z150. S2000|G50 S
SpindleLimitInItsPlane|fanuc|G18 G50 S4500 R1|G50 S
Finishing|fanuc|G70 P10 Q20|a turning cycle over
Roughing|fanuc|G71 P10 Q20 U0.4 W0.1 F0.25|a turning cycle over
RoughingOnOneLine|haas|G71 P10 Q20 D0.1 U0.01 W0.005 F0.012|a turning cycle over
Facing|fanuc|G72 P10 Q20 U0.4 W0.1 F0.25|a turning cycle over
Repeating|fanuc|G73 P10 Q20 U0.4 W0.1 F0.25|a turning cycle over
DepthOfCut|fanuc|G71 U2. R1.|a turning cycle's depth
DepthOfFacing|fanuc|G72 W2. R1.|a turning cycle's depth
DepthOfRepeating|fanuc|G73 U10. W10. R5|a turning cycle's depth
RoughingOfLinuxcnc|linuxcnc|G71 Q100 X15 Z3 D1 I1 R0.3|a turning cycle over a contour, G70 to G72 Q
RoughingOfLinuxcncInOneSense|linuxcnc|G72.1 Q100 X15 Z3 D1 I1 R0.3|a turning cycle over a contour, G70 to G72 Q
Thread|fanuc|G32 Z-20. F1.5|a thread
ThreadingOfLinuxcnc|linuxcnc|G76 P1.5 Z-20 I-2 J0.2 K1 R1.5|a threading cycle
SpindleLimit|siemens|G96 S200 LIMS=3000|LIMS
SpindleLimitOfSpindle|siemens|LIMS[1]=3000|LIMS
Stock|siemens|CYCLE95("CONTOUR",2,0.2,0.3,0.4,0.3,0.2,0.1,9,0,0,1)|a turning cycle, CYCLE93
LapCycle|fanuc|G85 NLAP1 D4 U0.4 W0.2 F0.3|NLAP
)";

constexpr const char* kTwoKinds = R"(
ToolAndSurfaceSpeed|fanuc|T0101\nG96 S180 M3\nG97 S800|T with
ToolAndFeed|fanuc|T0303\nG99\nG94|T with
ToolOfSixDigits|fanuc|T010101\nG99\nG94|T with
ToolAndSmallFeed|haas|T0202\nG1 Z4. F0.2|T with
LimitOfOtherSystems|fanuc|G92 S2500\nT0101|G92 with S
LimitBesideOthers|fanuc|G0 G40 G50 S2000 M3\nT0101|G50 S
CycleAndSmallFeed|fanuc|G94 X20. Z-2. F0.2|G90, G92, G94
CycleOfSystemB|fanuc|T0101\nG77 X20. Z-2. F100.|T with
ThreadAndTool|fanuc|T0404\nG92 X19. Z-20. F1.5|T with
IncrementsAndTool|fanuc|T0404\nG0 X42. W-2.|T with
HomeAndTool|fanuc|G28 U0. W0.\nT0404|increments
Grooving|fanuc|T0404\nG75 R1.\nG75 X10. Z-5. P500 Q500 F80.|T with
SurfaceSpeedPerRevolution|siemens|G95\nG96 S200 M3\nG97 S800\nG94|feed per revolution
)";

INSTANTIATE_TEST_SUITE_P(Certain, Mark, testing::ValuesIn(marks_in(kCertain, true)), &name_of_mark);
INSTANTIATE_TEST_SUITE_P(TwoKinds, Mark, testing::ValuesIn(marks_in(kTwoKinds, false)),
                         &name_of_mark);

TEST(LatheProgram, OfHeidenhainIsCopied) {
  constexpr gcode::Language kKlartext = gcode::Language::kKlartext;
  const SmoothOptions options = options_for("heidenhain");
  const std::string cuts = wave_part(kKlartext, 0);
  for (const char* comment : {"", "; FUNCTION MODE TURN\n"}) {
    const std::string text = head_of(kKlartext) + comment + cuts + tail_of(kKlartext);
    EXPECT_EQ(rewritten_runs(smoothed(text, options)), 1U) << comment;
  }
  for (const char* mark : {"FUNCTION MODE TURN\n", "FUNCTION TURNDATA SPIN VCONST:ON VC:200\n"}) {
    expect_copied(head_of(kKlartext) + cuts + mark + tail_of(kKlartext), "heidenhain",
                  "turning, FUNCTION MODE TURN");
  }
}

class Mill : public testing::TestWithParam<MarkCase> {};

TEST_P(Mill, IsSmoothed) {
  const MarkCase& c = GetParam();
  const SmoothResult result = smoothed(c.lines + "\n" + wave_program(), options_of(c.target));
  EXPECT_EQ(lathe_warning(result), nullptr) << lathe_warning(result)->message;
  EXPECT_GE(rewritten_runs(result), 1U);
}

// Name | control | lines of a mill before its cuts.
constexpr const char* kMills = R"(
ToolNumber|fanuc|T0101 M6\nT0202\nM6
ToolAndSurfaceSpeed|fanuc|T0101\nG96 S200 M3\nG97 S8000
SafetyLine|fanuc|G0 G17 G40 G49 G50 G80 G90 S5000 M3
EndOfScaling|haas|G50
OriginByG92|linuxcnc|G92 X0 Y0 Z0
ReturnOfCycle|fanuc|G21 G99 G81 X5. Y5. Z-3. R2. F100.\nG80
ChipBreaking|fanuc|G21 G98 G73 X5. Y5. Z-3. R2. Q1. F100.\nG80
LeftTapping|fanuc|G21 G98 G74 X5. Y5. Z-3. R2. P500 Q1. F100.\nG80
FineBoring|fanuc|G21 G98 G76 X5. Y5. Z-3. R2. Q0.1 P500 I1. J1. F100.\nG80
UnitsOfOldControls|siemens|G71 G90 G17
ParallelAxes|fanuc|G21\nG0 U5. W10.\nG0 X1. W20.\nT0101
InverseTime|linuxcnc|G21 G93\nG1 X1 F0.5\nG94\nT0101
TappingPerRevolution|siemens|G95\nG94
FixedPoint|siemens|G75 X0 Z0\nG74 X0 Z0
NamesInTexts|siemens|MSG("LIMS=3000 CYCLE95(")\n; LIMS=3000
MillingCycle|siemens|CYCLE832(0.01,3)
)";

INSTANTIATE_TEST_SUITE_P(LooksLikeALathe, Mill, testing::ValuesIn(marks_in(kMills, false)),
                         &name_of_mark);

TEST(LatheProgram, IsNotEveryProgramInXAndZ) {
  for (const char* head : {"G21\n", "G21 G18\nT1 M6\n", "G21\nG90 X30. Z5. F300.\n"}) {
    const SmoothResult result = smoothed(contour(head), options_for("fanuc"));
    EXPECT_EQ(lathe_warning(result), nullptr) << head;
    EXPECT_EQ(rewritten_runs(result), 1U) << head;
  }
}

TEST(LatheProgram, IsProvedOnlyWhereNothingThatActsDiffers) {
  const std::string text = contour("G21\nG50 S2000\n");
  EXPECT_TRUE(verdict(text, text, 0.01).proved());
  std::string with_comment = text;
  with_comment.insert(text.find("G0 X40."), "(ROUGHING)\n");
  EXPECT_TRUE(verdict(text, with_comment, 0.01).proved());
  // A place in another spelling, a place within the tolerance, a line the less: on a mill all three
  // would keep it.
  for (const auto& [what, by] :
       {std::pair("G1 Z0. F200.", "G1 Z0.00 F200."), std::pair("G1 Z0. F200.", "G1 Z0.005 F200."),
        std::pair("X0.4000", "(X0.4000"), std::pair("S2000", "S2001"),
        std::pair("G50 S2000\n", "")}) {
    std::string changed = text;
    changed.replace(text.find(what), std::string_view(what).size(), by);
    EXPECT_FALSE(verdict(text, changed, 0.01).proved()) << what;
    EXPECT_FALSE(verdict(changed, text, 0.01).proved()) << what;
  }
}

TEST(LatheProgram, SaysSoInTheSummaryEvenWhereNothingMoves) {
  const SmoothOptions options = options_for("fanuc");
  for (const std::string& text :
       {contour("G21\nG50 S2000\n"), std::string("G21\nG50 S2000\nG0 X4.\nM30\n")}) {
    const SmoothResult result = smoothed(text, options);
    const gcode::SourceText source("part.nc", text);
    const std::string summary = summary_text(
        {.source = source, .options = options, .result = result, .output_file = "new.nc"});
    EXPECT_NE(summary.find("lathe-program"), std::string::npos) << summary;
  }
}

TEST(LatheProgram, IsNeitherTranslatedNorAllowed) {
  const std::string text = contour("G21\nG50 S2000\n");
  SmoothOptions options = options_for("heidenhain");
  options.convert = true;
  EXPECT_FALSE(smoothed(text, options).understood);
  options = options_for("fanuc");
  options.allowed = {"lathe-program"};
  EXPECT_EQ(rewritten_runs(smoothed(text, options)), 0U);
}

TEST(LatheProgram, IsNotTimed) {
  const ReadText read(contour("G21\nG50 S2000\n"));
  const ProgramSteps steps = read_steps(read.program, read.meaning, {});
  EXPECT_TRUE(std::ranges::none_of(steps.steps, [](const ProgramStep& step) {
    return step.kind == StepKind::kCut || step.kind == StepKind::kRapid;
  }));
}

std::string lathe_passes(int count) {
  std::string text = "G21 G90 G17\n";
  for (int i = 0; i < count; ++i) {
    text += "G0 X0 Z5\n";
    text += in_x_and_z({.lines = 60}) + "G0 Z5\n";
  }
  return text;
}

TEST(LatheProgram, IsLeftToTheWholeHoweverLateItShows) {
  const std::string text = lathe_passes(30);  // more blocks than are looked at at once
  const SmoothOptions options = options_for("fanuc");
  ASSERT_TRUE(in_windows(text + "M30\n", options, 40).cut());
  const auto inspected_as_whole = [](const std::string& program) {
    const InspectLimits limits{.parts = {.least_text = 0}};
    return inspect(gcode::SourceText("part.nc", program), {}, {}, limits).as_whole;
  };
  ASSERT_FALSE(inspected_as_whole(text + "M30\n"));
  for (const char* end : {"G50 S2000\nM30\n", "T0101\nG97 S800 M3\nG1 Z0 F0.2\nM30\n"}) {
    EXPECT_FALSE(in_windows(text + end, options, 40).cut()) << end;
    EXPECT_TRUE(inspected_as_whole(text + end)) << end;
  }
}

TEST(LatheProgram, IsNoneInWindowsWhereYIsNamedBehindItsMarks) {
  const SmoothOptions options = options_for("fanuc");
  const std::string text =
      "T0101\nG99\nG94\n" + lathe_passes(3) + "G0 Y5\n" + lathe_passes(30) + "M30\n";
  const InWindows windows = in_windows(text, options, 40);
  ASSERT_TRUE(windows.cut());
  EXPECT_GT(windows.parts, 3U);
  expect_same(windows, as_a_whole(text, options));
  EXPECT_GT(rewritten_runs(windows.result), 15U);
}

}  // namespace
}  // namespace batten::postproc
