// What takes over where the tool stands hides from then on how far that is from where it stood: the
// place must be the same there, and only there.
#include <gtest/gtest.h>

#include "tests/support/wavy_programs.h"

namespace batten::postproc {
namespace {

constexpr double kPlaceTolerance = 0.01;
constexpr auto kSiemensWords = gcode::Language::kSiemens;
constexpr auto kKlartextWords = gcode::Language::kKlartext;

struct PlaceCase {
  std::string name;
  std::string before;  // of which the move to X10 ends elsewhere in the new program
  std::string moved = "X10 Y5";
  std::string by = "X10.009 Y5";
  gcode::Language language = gcode::Language::kRs274;

  [[nodiscard]] Verification verdict_on(const std::string& after) const {
    return verify(ReadText(before, language).read(), ReadText(after, language).read(),
                  kPlaceTolerance);
  }
};

std::string plain(const std::string& word, const std::string& behind = "G1 X9 Y2\nX20 Y9\n") {
  return "G21 G90 G17\nG0 X0 Y0 Z1\nG1 X5 Y1 F500\nX10 Y5\n" + word + "\n" + behind + "M30\n";
}

std::string siemens(const std::string& statement) {
  return "G71 G90 G17\nG0 X0 Y0 Z1\nG1 X5 Y1 F500\nG1 X10 Y5\n" + statement +
         "\nG1 X9 Y2\nG1 X20 Y9\nM30\n";
}

std::string klartext(const std::string& statement) {
  return "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 Z+1 R0 FMAX\n3 L X+5 Y+1 F500\n"
         "4 L X+10 Y+5\n5 " +
         statement + "\n6 L X+9 Y+2\n7 L X+20 Y+9\n8 END PGM A MM\n";
}

std::vector<std::string> places_of(const PlaceCase& param) {
  std::vector<std::string> ids;
  const auto found = param.verdict_on(replaced(param.before, param.moved, param.by));
  for (const Violation& violation : found.violations) ids.push_back(violation.id);
  return ids;
}

std::string name_of_case(const testing::TestParamInfo<PlaceCase>& info) { return info.param.name; }

class PlaceIsTakenOver : public testing::TestWithParam<PlaceCase> {};

TEST_P(PlaceIsTakenOver, SoItMustBeTheSame) {
  EXPECT_EQ(places_of(GetParam()), std::vector<std::string>{"place-moved"});
  EXPECT_TRUE(GetParam().verdict_on(GetParam().before).violations.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Words, PlaceIsTakenOver,
    testing::Values(
        PlaceCase{"G92", plain("G92 X1")}, PlaceCase{"G92OfAnAxisThatIsNotMoved", plain("G92 Z5")},
        PlaceCase{"G92BehindARapidOfTheOtherAxes", plain("G0 Z5\nG92 X1")},
        PlaceCase{"G92BehindADwell", plain("G4 P1\nG92 X1")},
        PlaceCase{"G92BehindAHomedAxis", plain("G28 Z0\nG92 X1")},
        PlaceCase{"G92BehindAnotherOffset", plain("G55\nG92 X1")},
        PlaceCase{"G92BehindAMoveOfWhichOneAxisIsKnown", plain("G55\nG0 Y2\nG92 X1")},
        PlaceCase{"G92BehindIncrements", plain("G91\nG1 X2\nG92 X1\nG90")},
        PlaceCase{"G92BehindAnArc", plain("G2 X12 Y5.1 R5\nG92 X1"), "X12 Y5.1 R5",
                  "X12.002 Y5.1 R5"},
        PlaceCase{"G92OfAPrinter", plain("G92 X0 Y0 ; here")},
        PlaceCase{"WorkOffsetOfThePlace", plain("G10 L20 P1 X0")},
        PlaceCase{"ToolLengthOfThePlace", plain("G10 L10 P1 Z0")},
        PlaceCase{"LocalOrigin", plain("G52 X1")},
        PlaceCase{"HomeIsStored", plain("G28.1\nG1 X3\nG28")},
        PlaceCase{"SecondHomeIsStored", plain("G30.1")},
        PlaceCase{"Parameter", plain("#1 = #5420")},
        PlaceCase{"MacroOfThePlace", plain("G65 P9810 X1")},
        PlaceCase{"Subprogram", plain("M98 P100")}, PlaceCase{"MacroOfTheUser", plain("M150")},
        PlaceCase{"HomeOffsetsOfThePlace", plain("M428")},
        PlaceCase{"HiddenBlock", plain("/G92 X1")},
        PlaceCase{"CommentBeforeWhatIsNotUnderstood", plain("(x) G92 X[#7]")},
        PlaceCase{"Preset", siemens("PRESETON(X, 1)"), "X10 Y5", "X10.009 Y5", kSiemensWords},
        PlaceCase{"PlaceAsAValue", siemens("R1=$AA_IW[X]"), "X10 Y5", "X10.009 Y5", kSiemensWords},
        PlaceCase{"KlartextPlaceAsAValue", klartext("FN 18: SYSREAD Q1 = ID270 NR1 IDX1"),
                  "X+10 Y+5", "X+10.009 Y+5", kKlartextWords},
        PlaceCase{"KlartextDatum", klartext("CYCL DEF 7.0 DATUM SHIFT"), "X+10 Y+5", "X+10.009 Y+5",
                  kKlartextWords}),
    name_of_case);

class PlaceIsNotTakenOver : public testing::TestWithParam<PlaceCase> {};

TEST_P(PlaceIsNotTakenOver, SoItMayBeWithinTheTolerance) {
  EXPECT_EQ(places_of(GetParam()), std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(
    Words, PlaceIsNotTakenOver,
    testing::Values(PlaceCase{"Nothing", plain("")}, PlaceCase{"Coolant", plain("M8")},
                    PlaceCase{"Dwell", plain("G4 P1")}, PlaceCase{"Message", plain("(MSG, one)")},
                    PlaceCase{"Home", plain("G28 Z0", "G0 X0 Y0\n")},
                    PlaceCase{"WorkOffset", plain("G55", "G0 X0 Y0 Z0\n")},
                    PlaceCase{"Drilling", plain("G81 X1 Y1 Z-1 R1 F100\nG80", "G0 X0 Y0\n")},
                    PlaceCase{"G92BehindAPlaceThatIsKnownAgain", plain("G0 X0 Y0\nG92 X1")},
                    PlaceCase{"KlartextDwell", klartext("M8"), "X+10 Y+5", "X+10.009 Y+5",
                              kKlartextWords}),
    name_of_case);

// Where the place cannot be said any more it may be another one still, on the axes that nothing has
// named since.
TEST(PlaceIsTakenOverByName, TheMessageSaysHowFarAndWhere) {
  const std::string before = plain("G92 X1");
  const auto found = verdict(before, replaced(before, "X10 Y5", "X10.009 Y5"), kPlaceTolerance);
  ASSERT_EQ(found.violations.size(), 1U);
  EXPECT_EQ(found.violations[0].old_line, 5U);
  EXPECT_NEAR(found.violations[0].deviation_mm, 0.009, 1e-9);
  EXPECT_NE(found.violations[0].message.find("0.009 mm"), std::string::npos);
  EXPECT_NE(found.violations[0].message.find("G92"), std::string::npos);
}

}  // namespace
}  // namespace batten::postproc
