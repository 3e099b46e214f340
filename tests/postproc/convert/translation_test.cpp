// Programs of plain words for controls of another language: what is written, what is refused, and
// that the proof against the old program finds every change.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "gcode/controls/built_in.h"
#include "postproc/stream/smooth_result.h"
#include "tests/support/conversion_programs.h"

namespace batten::postproc {
namespace {

SmoothOptions converting_to(std::string_view target) {
  SmoothOptions options = options_for(target);
  options.convert = true;
  return options;
}

// Plain words against a text of the target's language.
Verification verdict_for(std::string_view target, const std::string& before,
                         const std::string& after, double tolerance_mm = 0.01) {
  const gcode::Control& control = *gcode::find_control(target);
  const ReadText old_text(before, gcode::Language::kRs274);
  const ReadText new_text(after, control.language, control.curves);
  return verify(old_text.read(), new_text.read(), tolerance_mm);
}

std::vector<std::string> messages_of(const SmoothResult& result) {
  std::vector<std::string> messages;
  for (const gcode::Diagnostic& each : result.diagnostics) {
    if (each.severity == gcode::Severity::kError) messages.push_back(each.message);
  }
  return messages;
}

// --- what is written ----------------------------------------------------------------------------

constexpr const char* kPart =
    "%\nO100 (part)\nN10 G21 G90 G17 G40 G49 G80\nN20 T5 M6\nN30 G43 H5\nN40 S3000 M3\nN50 M8\n"
    "N60 G0 X0 Y0\nN70 Z5\nN80 G1 Z-1 F300 (down)\nN90 X10 F500\nN100 G2 X20 Y0 I5 J0\n"
    "N110 G3 X20 Y0 I-5 J0\nN120 S4000\nN130 G1 X25.25\nN140 G0 Z50\nN150 M9\nN160 M5\nN170 M30\n"
    "%\n";

TEST(Translation, SaysAProgramInTheWordsOfTheTarget) {
  struct Row {
    const char* target;
    std::string text;
    const char* written;
  };
  // Derived by hand.
  const Row rows[] = {
      // The centre of G2 is (10+5, 0), that of the full turn (20-5, 0); F is said again after a
      // TOOL
      // CALL.
      {"heidenhain", kPart,
       "0 BEGIN PGM TEST MM\n1 ; part\n2 TOOL CALL 5 Z S3000\n3 M3\n4 M8\n"
       "5 L X+0 Y+0 R0 FMAX\n6 L Z+5 FMAX\n7 ; down\n8 L Z-1 F300\n9 L X+10 F500\n"
       "10 CC X+15 Y+0\n11 C X+20 Y+0 DR-\n12 CC X+15 Y+0\n13 C X+20 Y+0 DR+\n"
       "14 TOOL CALL Z S4000\n15 L X+25.25 F500\n16 L Z+50 FMAX\n17 M9\n18 M5\n19 M30\n"
       "20 END PGM TEST MM\n"},
      // The length of the tool is that of its first edge. The control takes arcs of less than 350
      // degrees: the full turn about (15, 0) is two, (20, 0) to (10, 0) and back. N numbers are
      // left
      // out, and so is an end that the arc does not change.
      {"siemens", kPart,
       "%_N_TEST_MPF\nG710\nG17 G40 G90 G94\n; part\nT5 M6\nD1\nS3000 M3\nM8\nG0 X0 Y0\n"
       "Z5\n; down\nG1 Z-1 F300\nX10 F500\nG2 X20 I5\nG3 X10 I-5\nX20 I5\nS4000\n"
       "G1 X25.25\nG0 Z50\nM9\nM5\nM30\n"},
      // 1 inch is 25.4 mm, 12 inch/min are 304.8 mm/min; 0.3333 inch are 8.46582 mm.
      {"heidenhain", "G20 G90\nG0 X1 Y0 Z1\nG1 Z-.5 F12\nX.3333\nG0 Z1\nM2\n",
       "0 BEGIN PGM TEST MM\n1 L X+25.4 Y+0 Z+25.4 R0 FMAX\n2 L Z-12.7 F304.8\n3 L X+8.4658\n"
       "4 L Z+25.4 FMAX\n5 M2\n6 END PGM TEST MM\n"}};
  for (const Row& row : rows) {
    EXPECT_EQ(proved_text(row.text, converting_to(row.target)), row.written);
  }
}

TEST(Translation, TakesTheActiveDatumForAWorkOffsetOnlyWhereTheUserSaysSo) {
  const std::string text = "G21 G90 G54\nG0 X1 Y2 Z3\nG1 Z0 F100\nX5\nM2\n";
  SmoothOptions options = converting_to("heidenhain");
  const SmoothResult refused = smoothed(text, options);
  EXPECT_FALSE(refused.understood);
  ASSERT_EQ(messages_of(refused).size(), 1U);
  EXPECT_TRUE(messages_of(refused).front().starts_with("G54 names a work offset"));
  options.allowed = {"work-offset"};
  const std::string written = proved_text(text, options);
  EXPECT_NE(written.find("1 ; G54: its datum is active\n2 L X+1 Y+2 Z+3 R0 FMAX\n"),
            std::string::npos)
      << written;
  EXPECT_TRUE(verdict_for("heidenhain", text, written).proved());
  EXPECT_FALSE(verdict_for("heidenhain", text, replaced(written, "G54", "G55")).proved());
}

// FreeCAD's first motion: up, without a length, before the tool is put in.
TEST(Translation, CountsLengthsBehindG49OnlyWhereTheUserSaysSo) {
  const std::string text = "G21 G90 G49\nG0 Z12\nT1 M6\nG43 H1\nG0 X1 Y2 Z3\nG1 Z0 F100\nM2\n";
  SmoothOptions options = converting_to("heidenhain");
  EXPECT_FALSE(smoothed(text, options).understood);
  options.allowed = {"tool-length"};
  const std::string written = proved_text(text, options);
  const std::string remark = "1 ; G49: the length of the tool counts\n";
  EXPECT_NE(written.find(remark + "2 L Z+12 R0 FMAX\n"), std::string::npos) << written;
  EXPECT_EQ(written.find("G43"), std::string::npos);
  EXPECT_FALSE(verdict_for("heidenhain", text, replaced(written, remark, "")).proved());
}

TEST(Translation, HasNoUseForALengthThatIsOffAndOnAgain) {
  const std::string text = "G21 G90\nT1 M6\nG49\nG43 H1\nG0 X1 Y2 Z3\nG1 Z0 F100\nM2\n";
  const std::string written = proved_text(text, converting_to("heidenhain"));
  EXPECT_EQ(written.find("G4"), std::string::npos) << written;
}

// --- smoothed in the other language -----------------------------------------------------------

class TranslatedWave : public testing::TestWithParam<const char*> {};

TEST_P(TranslatedWave, IsSmoothedAndProvedAgainstTheOldProgram) {
  const std::string text = wave_program();
  const SmoothResult result = smoothed(text, converting_to(GetParam()));
  ASSERT_TRUE(result.understood) << testing::PrintToString(messages_of(result));
  EXPECT_TRUE(result.proved);
  EXPECT_GE(rewritten_runs(result), 1U);
  EXPECT_TRUE(verdict_for(GetParam(), text, result.text).proved());
  EXPECT_LT(lines_of(result.text).size(), lines_of(text).size());
  EXPECT_EQ(result.bytes_out, result.text.size());
  // Places are those of the program that the user has.
  for (const RunReport& run : result.runs) {
    if (run.status != RunStatus::kRewritten) continue;
    EXPECT_GE(run.first_line, 4U);
    EXPECT_LE(run.last_line, lines_of(text).size() - 3);
  }
  EXPECT_EQ(smoothed(result.text, options_for(GetParam())).text, result.text) << "a second pass";
}

TEST_P(TranslatedWave, TellsTheWholeToleranceInInchesToo) {
  const Wave wave{.step = 0.008, .height = 0.08, .length = 0.7, .decimals = 5, .feed = 79};
  const std::string text = replaced(wave_program(wave, "G20"), "Z-1 F300", "Z-.1 F12");
  const SmoothResult result = smoothed(text, converting_to(GetParam()));
  ASSERT_TRUE(result.proved) << testing::PrintToString(messages_of(result));
  ASSERT_GE(rewritten_runs(result), 1U);
  EXPECT_NE(result.text.find("Batten: smoothed within 0.01 mm"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Targets, TranslatedWave,
                         testing::Values("heidenhain", "itnc530", "siemens"),
                         [](const auto& test) { return std::string(test.param); });

TEST(Translation, KeepsWithinTheToleranceAsSplines) {
  SmoothOptions options = converting_to("itnc530");
  options.output = Form::kCurves;
  const SmoothResult result = smoothed(bend_program(), options);
  ASSERT_TRUE(result.proved) << testing::PrintToString(messages_of(result));
  EXPECT_NE(result.text.find(" SPL "), std::string::npos);
  EXPECT_TRUE(verdict_for("itnc530", bend_program(), result.text).proved());
}

// --- what is refused ----------------------------------------------------------------------------

struct RefusedCase {
  const char* name;
  const char* blocks;  // between a head and the end
  const char* told;    // for heidenhain; without the target's name
};

TEST(Translation, ListsWhatCannotBeSaidAndWritesNothing) {
  const RefusedCase kRefused[] = {
      {"Dwell", "G4 P1\n",
       "G4 P1 waits for seconds on some controls and for milliseconds on others; "
       "--source ngc, grbl, fanuc or haas says which"},
      {"Cycle", "G81 X1 Y1 Z-1 R1 F100\nG80\nG0 X0\n", "G81 may mean something else there"},
      {"Home", "G28\nG0 X0 Y0 Z5\n", "G28 may mean something else there"},
      {"Increment", "G91\nG1 X1 F100\nG90\n", "G1 X1 F100 is an increment"},
      {"OtherPlane", "G18\nG2 X2 Z5 I1 K0 F100\nG17\n",
       "G2 X2 Z5 I1 K0 F100 is an arc in another plane"},
      {"Helix", "G2 X2 Y0 Z4 I1 J0 F100\n", "G2 X2 Y0 Z4 I1 J0 F100 is a helix"},
      {"OtherAxis", "G1 X1 A5 F100\nG0 X0 Y0 Z5\n", "A5 may mean something else there"},
      {"BlockDelete", "/G0 X3\nG0 X0 Y0 Z5\n",
       "/G0 X3 is left out by some controls, run by others"},
      {"Blending", "G64 P0.01\n",
       "G64 says how far corners may be rounded, which is no word there"},
      {"StopWithSpindleOn", "M0\n",
       "M0 stops spindle and coolant on some controls, and they may be on"},
      {"SpindleStopInMotion", "G0 X5 M5\nM3\n",
       "M5 acts before or after the motion of its block: controls differ"},
      {"SpeedInCut", "G1 X5 S4000 F100\n", "S4000 changes the speed in a cutting move"},
      {"ToolOnly", "T3\nG0 X0 Y0 Z5\n",
       "T3 changes the tool on some controls, and on others only fetches it"},
      {"LengthOfAnotherTool", "T3 M6\nG43 H4\nM3\nG0 X0 Y0\n",
       "G43 names the length of another tool"},
      {"ToolWithSpindleOn", "T3 M6\nG43 H3\nG0 X0 Y0 Z5\n",
       "M6 finds the spindle on, and controls differ in whether it turns in the cut "
       "after it"},
      {"LengthNotSaid", "T3 M6\nM3\nG0 Z5\nX0 Y0\n",
       "G0 Z5 moves along Z after a tool change without G43 or D, and the length "
       "always counts there; --allow tool-length takes it all the same"},
      {"NoLength", "G49\nG0 X0 Y0 Z5\n",
       "G49 moves without the length of the tool, which always counts there; --allow "
       "tool-length takes it all the same"},
      {"ActiveComment", "(MSG, hello)\n", "(MSG, hello) acts on its control"},
      {"FarAway", "G0 X100000\n", "G0 X100000 goes beyond the range of the control"},
      {"Parameter", "#1=5\nG0 X0 Y0 Z5\n", "#1=5 is no block of plain words"}};
  for (const RefusedCase& refused : kRefused) {
    const std::string text = std::string("G21 G90 G17\nS3000 M3\nG0 X0 Y0 Z5\n") + refused.blocks +
                             "G1 X1 F100\nM5\nM2\n";
    const SmoothResult result = smoothed(text, converting_to("heidenhain"));
    EXPECT_FALSE(result.understood) << refused.name;
    EXPECT_EQ(result.text, "") << refused.name;
    EXPECT_EQ(messages_of(result),
              std::vector<std::string>{std::string(refused.told) + " (target heidenhain)"});
    EXPECT_TRUE(std::ranges::all_of(result.diagnostics, [](const gcode::Diagnostic& each) {
      return each.severity != gcode::Severity::kError || each.id == "cannot-convert";
    })) << refused.name;
  }
}

// The motion without the length of its tool is an obstacle as well as the length behind it.
TEST(Translation, TakesNoLengthBehindAMotionAlongZ) {
  const std::string text =
      "G21 G90\nG0 X0 Y0 Z5\nT3 M6\nG0 Z50\nG43 H3\nG0 X0 Y0 Z5\nG1 X1 F100\nM2\n";
  SmoothOptions options = converting_to("heidenhain");
  options.allowed = {"tool-length"};
  EXPECT_EQ(messages_of(smoothed(text, options)),
            std::vector<std::string>{
                "G43 comes after a motion without the length of the tool (target heidenhain)"});
}

TEST(Translation, ListsEveryBlockThatCannotBeSaid) {
  const std::string text = "G21 G90\nG0 X0 Y0 Z5\nG61\nM7\nG1 X1 F100\nG28\nM2\n";
  const SmoothResult result = smoothed(text, converting_to("siemens"));
  EXPECT_EQ(messages_of(result),
            (std::vector<std::string>{"G61 may mean something else there (target siemens)",
                                      "M7 may mean something else there (target siemens)",
                                      "G28 may mean something else there (target siemens)"}));
}

TEST(Translation, IsForThoseWhoAskForIt) {
  const SmoothResult result = smoothed("%\n" + wave_program(), options_for("heidenhain"));
  EXPECT_TRUE(result.text.empty() || result.text == "%\n" + wave_program());
}

// --- the proof ----------------------------------------------------------------------------------

TEST(Translation, ThatIsDamagedIsNotProved) {
  constexpr Damage kOfThePart[] = {{"Tool", "TOOL CALL 5", "TOOL CALL 6"},
                                   {"Axis", "TOOL CALL 5 Z", "TOOL CALL 5 Y"},
                                   {"Oversize", "Z S3000", "Z S3000 DL+1"},
                                   {"Speed", "S3000", "S3001"},
                                   {"SpeedLost", "14 TOOL CALL Z S4000\n", ""},
                                   {"SpindleLost", "3 M3\n", ""},
                                   {"SpindleBackwards", "3 M3\n", "3 M4\n"},
                                   {"CoolantLost", "4 M8\n", ""},
                                   {"CoolantLate", "17 M9\n18 M5", "17 M5\n18 M9"},
                                   {"RapidPlace", "Z+50 FMAX", "Z+49 FMAX"},
                                   {"RapidLost", "6 L Z+5 FMAX\n", ""},
                                   {"RapidAsCut", "L Z+50 FMAX", "L Z+50"},
                                   {"CutAsRapid", "L Z-1 F300", "L Z-1 FMAX"},
                                   {"Feed", "F500", "F501"},
                                   {"FeedLost", "L X+25.25 F500", "L X+25.25"},
                                   {"Place", "X+25.25", "X+25.27"},
                                   {"Sense", "Y+0 DR-", "Y+0 DR+"},
                                   {"Centre", "CC X+15 Y+0", "CC X+15 Y+0.5"},
                                   {"Compensation", "R0 FMAX", "RL FMAX"},
                                   {"Unit", "TEST MM", "TEST INCH"},
                                   {"Increment", "L X+10", "L IX+10"},
                                   {"Mirror", "4 M8\n", "4 M8\n4 CYCL DEF 8.1 X\n"},
                                   {"End", "19 M30\n", ""}};
  const std::string text = smoothed(kPart, converting_to("heidenhain")).text;
  ASSERT_TRUE(verdict_for("heidenhain", kPart, text).proved());
  for (const Damage& damage : kOfThePart) {
    EXPECT_FALSE(verdict_for("heidenhain", kPart, replaced(text, damage.from, damage.to)).proved())
        << damage.name;
  }
  // What the new text does not say at all.
  std::istringstream blocks(
      "G92 X0|G1 A5|G1 X20 A5|G10 L2 P1 X5|G4 P1|M7|G61|G68 X0 Y0 R10|T9|G55|G52 X5|"
      "(MSG, wait)|/M9|G28 Z0|G53 Z0|M98 P100|G81 X20 Y0 Z-2 R1|E5|G41 D1|M0|#1=2|G51 P2|"
      "G96 S100|U5|G43 H6|G49|M6 T7");
  for (std::string block; std::getline(blocks, block, '|');) {
    std::string more = kPart;
    more.insert(more.find("N130"), block + "\n");
    EXPECT_FALSE(verdict_for("heidenhain", more, text).proved()) << block;
  }
}

// What is written is proved, and moving one place by more than the tolerance is found.
TEST(Translation, OfRandomProgramsIsProved) {
  constexpr unsigned kPrograms = 60;
  for (unsigned seed = 1; seed <= kPrograms; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::string text = RandomProgram(seed).text();
    for (const char* target : {"heidenhain", "siemens"}) {
      SmoothOptions options = converting_to(target);
      options.method = Method::kNone;
      options.allowed = {"tool-length"};
      // The last rapid before the end, at another place.
      std::string moved = proved_text(text, options);
      const std::string z = target == std::string_view("heidenhain") ? "Z+50" : "Z50";
      moved.replace(moved.rfind(z), z.size(), z.substr(0, z.size() - 1) + "1");
      EXPECT_FALSE(verdict_for(target, text, moved).proved()) << target;
    }
  }
}

}  // namespace
}  // namespace batten::postproc
