#include "gcode/curves/nurbs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/distance/path_distance.h"
#include "tests/support/curve_texts.h"
#include "tests/support/nurbs_alarms.h"

namespace batten::gcode {
namespace {

using curve_tests::parsed;
using curve_tests::reading_of;
using curve_tests::refusal_of;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineBasis;
using geometry::BsplineCurve;
using geometry::Point3;

CurveSetting fanuc_setting() {
  CurveSetting setting;
  setting.places = {.decimals = 3, .always_point = true};
  setting.other = {.decimals = 3, .always_point = true};
  setting.feeds = {.decimals = 3, .always_point = true};
  return setting;
}

CurveSetting golden_setting() {
  CurveSetting setting = fanuc_setting();
  setting.axes = {true, true, false};
  setting.feed = 3000;
  return setting;
}

NurbsRules fanuc() { return fanuc_nurbs(Units::kMillimetre); }

std::string written(const BsplineCurve& curve, const CurveSetting& setting,
                    const NurbsRules& rules) {
  return text_of(nurbs_format([rules](Units) { return rules; }).write(curve, setting));
}

// --- what is written ----------------------------------------------------------------------------

constexpr const char* kGolden =
    "G06.2 P4 K0. X0. Y0. R1. F3000.\n"
    "K0. X10. Y0. R1.\n"
    "K0. X20. Y10. R1.\n"
    "K0. X30. Y10. R1.\n"
    "K40. X40. Y0. R1.\n"
    "K100.\n"
    "K100.\n"
    "K100.\n"
    "K100.\n";

TEST(Nurbs, LeavesTheWeightOutWhereItIsOne) {
  EXPECT_EQ(written(curve_tests::golden_curve(), golden_setting(), fanuc()),
            "G06.2 P4 K0. X0. Y0. F3000.\n"
            "K0. X10. Y0.\nK0. X20. Y10.\nK0. X30. Y10.\nK40. X40. Y0.\n"
            "K100.\nK100.\nK100.\nK100.\n");
}

// --- samples of the makers
// ------------------------------------------------------------------------

// The sample of the Syntec mill manual, p. 21: a parabola of order 3.
constexpr const char* kSyntecSample =
    "N001 G0 X0.0 Y0.0 Z0.0\n"
    "N002 G05 P10000\n"
    "N003 G06.2 P3 K0.0 X0.0 Y0.0 Z0.0 R1.0 F5000.\n"
    "N004 K0.0 X0.0 Y5.0 Z0.0 R1.0\n"
    "N005 K0.0 X5.0 Y5.0 Z0.0 R1.0\n"
    "N006 K1.0\nN007 K1.0\nN008 K1.0\n"
    "N009 G05 P0\n";

TEST(Nurbs, ReadsTheSampleOfSyntec) {
  const Program program = parsed(kSyntecSample);
  const NurbsRules rules = syntec_nurbs(Units::kMillimetre);
  EXPECT_EQ(curve_tests::short_forms(nurbs_alarms(program, rules)), std::vector<std::string>{});
  const CurveReading reading =
      reading_of(syntec_curves().read(program, 1, starting_at(Point3::Zero())));
  EXPECT_EQ(reading.blocks, 8U);
  ASSERT_EQ(reading.motions.size(), 1U);
  EXPECT_LT((geometry::point_at(reading.motions[0].piece, 0.5) - Point3(1.25, 3.75, 0)).norm(),
            1e-12);
}

// The two programs of the FANUC 15i manual B-63324EN, p. 129, that give alarms.
TEST(NurbsAlarms, AreThoseOfTheSamplesOfFanuc) {
  const std::string points =
      "G06.2 P4 X0. Y0. Z0. K0.\nX10. Y10. Z10. K0.\nX20. Y20. Z20. K0.\nX30. Y30. Z30. K0.\n";
  EXPECT_EQ(
      curve_tests::short_forms(nurbs_alarms(parsed(points + "K1.\nK1.\nK1.\nG01\n"), fanuc())),
      std::vector<std::string>{"8 PS1004"});
  EXPECT_EQ(curve_tests::short_forms(nurbs_alarms(parsed(points + "G01\n"), fanuc())),
            std::vector<std::string>{"5 PS1005"});
}

// A quarter circle of radius 10 as the rational parabola of the textbooks.
TEST(Nurbs, RefusesWeightsThatDiffer) {
  const Program program =
      parsed("G06.2 P3 K0 X10 Y0 R1\nK0 X10 Y10 R.70710678118654752\nK0 X0 Y10 R1\nK1\nK1\nK1\n");
  EXPECT_EQ(refusal_of(fanuc_curves().read(program, 0, starting_at({10, 0, 0}))),
            "weights that differ");
}

TEST(Nurbs, TooFewKnotDigitsAreADeviationOrARefusal) {
  int refused = 0;
  int off = 0;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const BsplineCurve curve = curve_tests::random_curve(seed, true);
    CurveSetting setting = fanuc_setting();
    setting.start = curve.control_points().front();
    NurbsRules rules = fanuc();
    rules.knots = {.digits = 3, .decimals = 0};  // the range has a hundred steps
    const std::string text = written(curve, setting, rules);
    if (!text.starts_with("G06.2")) {
      ++refused;
      EXPECT_EQ(text, "distinct knots meet when they are rounded");
      continue;
    }
    const CurveReading reading =
        reading_of(fanuc_curves().read(parsed(text), 0, starting_at(setting.start)));
    const auto compared = geometry::compare_paths(curve_tests::pieces_of(curve),
                                                  curve_tests::pieces_of(reading), 0.01);
    off += compared.verdict == geometry::Verdict::kBroken ? 1 : 0;
  }
  EXPECT_GT(refused, 0);
  EXPECT_GT(off, 10);
}

TEST(Nurbs, WritesInches) {
  CurveSetting setting = fanuc_setting();
  setting.units = Units::kInch;
  setting.places.decimals = 4;
  setting.axes = {true, true, false};
  setting.feed = 254;
  std::vector<Point3> points = curve_tests::golden_curve().control_points();
  for (Point3& point : points) point *= 2.54;
  const BsplineCurve curve(curve_tests::golden_curve().basis(), points);
  const std::string text = text_of(fanuc_curves().write(curve, setting));
  EXPECT_EQ(text.substr(0, text.find('\n', 40)),
            "G06.2 P4 K0. X0. Y0. F10.\nK0. X1. Y0.\nK0. X2. Y1.");
  const CurveReading reading =
      reading_of(fanuc_curves().read(parsed(text), 0, starting_at(Point3::Zero(), Units::kInch)));
  EXPECT_LT((geometry::end_point(reading.motions.back().piece) - Point3(101.6, 0, 0)).norm(), 1e-9);
}

TEST(Nurbs, MeetsItsEndsWithMoreDecimalsWhereTheSourceHasThem) {
  CurveSetting setting = golden_setting();
  setting.start = {0.00012, 0, 0};
  setting.last_decimals = 5;
  std::vector<Point3> points = curve_tests::golden_curve().control_points();
  points.back().x() = 40.00034;
  const std::string text = written({curve_tests::golden_curve().basis(), points}, setting, fanuc());
  EXPECT_NE(text.find("K0. X0.00012 "), std::string::npos) << text;
  EXPECT_NE(text.find("X40.00034 "), std::string::npos) << text;
}

// --- refusals
// -------------------------------------------------------------------------------------

struct RefusedCurve {
  const char* name;
  void (*change)(CurveSetting&, NurbsRules&, std::vector<Point3>&);
  const char* why;
};

class NurbsRefusals : public testing::TestWithParam<RefusedCurve> {};

TEST_P(NurbsRefusals, AreSaid) {
  CurveSetting setting = golden_setting();
  NurbsRules rules = fanuc();
  std::vector<Point3> points = curve_tests::golden_curve().control_points();
  GetParam().change(setting, rules, points);
  EXPECT_EQ(written({curve_tests::golden_curve().basis(), points}, setting, rules), GetParam().why);
}

INSTANTIATE_TEST_SUITE_P(
    Nurbs, NurbsRefusals,
    testing::Values(RefusedCurve{"StartBetweenTwoSteps",
                                 [](CurveSetting& setting, NurbsRules&, std::vector<Point3>&) {
                                   setting.start.x() = 0.0004;
                                 },
                                 "the start has more decimals than the control reads"},
                    RefusedCurve{"AxisThatMovesWithoutAWord",
                                 [](CurveSetting&, NurbsRules&, std::vector<Point3>& points) {
                                   points[2].z() = 1;
                                 },
                                 "an axis moves and has no word"},
                    RefusedCurve{"NoAxis",
                                 [](CurveSetting& setting, NurbsRules&, std::vector<Point3>&) {
                                   setting.axes = {false, false, false};
                                 },
                                 "no axis is named"},
                    RefusedCurve{"TwoAxesOnMitsubishi",
                                 [](CurveSetting&, NurbsRules& rules, std::vector<Point3>&) {
                                   rules = mitsubishi_nurbs(Units::kMillimetre);
                                 },
                                 "this control's G06.2 names X, Y and Z"},
                    RefusedCurve{"FarAway",
                                 [](CurveSetting&, NurbsRules&, std::vector<Point3>& points) {
                                   points[2].x() = 1e6;
                                 },
                                 "a position beyond 999999.999"},
                    RefusedCurve{"KnotsThatMeet",
                                 [](CurveSetting&, NurbsRules& rules, std::vector<Point3>&) {
                                   rules.knots = {.digits = 1,
                                                  .decimals = 0};  // one step from first to last
                                 },
                                 "distinct knots meet when they are rounded"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Nurbs, RefusesCurvesThatAreNotClamped) {
  const BsplineCurve curve(BsplineBasis(3, {0, 1, 2, 3, 4, 5, 6, 7, 8}),
                           curve_tests::golden_curve().control_points());
  EXPECT_EQ(written(curve, golden_setting(), fanuc()),
            "G06.2 is written for clamped cubic curves only");
}

// --- reading what is wrong
// ------------------------------------------------------------------------

struct BadText {
  const char* name;
  const char* text;
  const char* why;                    // of the reader
  std::vector<std::string> alarms{};  // of the control, after a G1 X0 Y0 as line 1
};

class NurbsBadTexts : public testing::TestWithParam<BadText> {};

TEST_P(NurbsBadTexts, AreRefusedByTheReader) {
  EXPECT_EQ(
      refusal_of(fanuc_curves().read(parsed(GetParam().text), 0, starting_at(Point3::Zero()))),
      GetParam().why);
}

TEST_P(NurbsBadTexts, GiveTheAlarmsOfTheControl) {
  const std::string text = "G1 X0 Y0\n" + std::string(GetParam().text);
  EXPECT_EQ(curve_tests::short_forms(nurbs_alarms(parsed(text), fanuc())), GetParam().alarms);
}

INSTANTIATE_TEST_SUITE_P(
    Nurbs, NurbsBadTexts,
    testing::Values(
        BadText{"NoKnot",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nX2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
                "a block without a knot",
                {"4 PS1002"}},
        BadText{"ThreeEndingKnots",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nG1 X5\n",
                "other words inside the curve",
                {"9 PS1004"}},
        BadText{"EndOfProgram",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\n",
                "the program ends inside the curve",
                {"8 PS1004"}},
        BadText{"NoEndingKnot",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nG0 X5\n",
                "other words inside the curve",
                {"6 PS1005"}},
        BadText{"NotClampedAtTheStart",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK.1 X3 Y0\nK1\nK1\nK1\nK1\n",
                "the first or the last knots are not all the same",
                {"2 PS1007"}},
        BadText{"NotClampedAtTheEnd",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK2\n",
                "the first or the last knots are not all the same",
                {"9 PS1007"}},
        BadText{"KnotTooOften",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1 X4 Y0\nK1 X5 Y0\nK1 X6 Y0\n"
                "K1 X7 Y0\nK1 X8 Y0\nK2\nK2\nK2\nK2\n",
                "an inner knot is repeated as often as the order",
                {"10 PS1008"}},
        BadText{"FirstKnotTooOften",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK0 X4 Y0\nK1\nK1\nK1\nK1\n",
                "a knot is repeated more often than the order",
                {"6 PS1008"}},
        BadText{"StartsElsewhere",
                "G06.2 K0 X.001 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
                "the first point is not the tool's position",
                {"2 PS1009"}},
        BadText{"MiscFunctionInside",
                "G06.2 K0 X0 Y0\nK0 X1 Y0 M8\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
                "other words inside the curve",
                {"3 foreign-word"}},
        BadText{"AxisTooLate",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0 Z1\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
                "an axis that the first block does not name",
                {"4 axis-not-in-first-block"}},
        BadText{"OrderFive",
                "G06.2 P5 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
                "P5, expected P2 to P4",
                {"2 order"}},
        BadText{"KnotDecreases",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK.6 X4 Y0\nK.5 X5 Y0\n"
                "K1\nK1\nK1\nK1\n",
                "a knot that decreases",
                {"7 knot-decreases"}},
        BadText{"FewPoints",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK1\nK1\nK1\nK1\n",
                "fewer points than the order",
                {"8 few-points"}},
        BadText{"PointBehindTheEnd",
                "G06.2 K0 X0 Y0\nK0 X1 Y0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1 X4 Y0\nK1\nK1\nK1\n",
                "a point after the ending knots",
                {"7 point-too-late", "10 PS1008"}},
        BadText{"WeightZero",
                "G06.2 K0 X0 Y0\nK0 X1 Y0 R0\nK0 X2 Y0\nK0 X3 Y0\nK1\nK1\nK1\nK1\n",
                "a weight that is not positive",
                {"3 weight"}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Nurbs, KnowsWhereTheToolStandsOrRefuses) {
  const CurveStart start = {{Point3::Zero(), {true, false, true}}, Units::kMillimetre};
  EXPECT_EQ(refusal_of(fanuc_curves().read(parsed(kGolden), 0, start)),
            "the tool's position is not known");
}

TEST(Nurbs, ReadsNothingElse) {
  for (const char* text : {"G1 X1\n", "(c)\n", "G6.1 X1 K0\n", "", "G05 P10000\n"}) {
    EXPECT_EQ(refusal_of(fanuc_curves().read(parsed(text), 0, starting_at(Point3::Zero()))),
              *text == '\0' ? "no block" : "no G06.2")
        << text;
  }
}

TEST(NurbsAlarms, HaveTheOrderOfTheLinesThoughKnotsAreJudgedAtTheEnd) {
  // Nine points and thirteen knots: the last four differ (line 14, where the curve ends), and K0
  // stands four times and once more in line 6.
  const std::string text =
      "G01 X0. Y0. Z0. F3000.\n"
      "G06.2 P4 K0. X0. Y0. Z0.\n"
      "K0. X10.\n"
      "K0. X20.\n"
      "K0. X30.\n"
      "K0. X40.\n"
      "K50. X50.\n"
      "K60. X60.\n"
      "K70. X70.\n"
      "K80. X80.\n"
      "K100.\nK100.\nK100.\nK110.\n"
      "G01 X90.\n";
  const CurveAlarms alarms = nurbs_alarms(parsed(text), fanuc());
  ASSERT_GE(alarms.size(), 2u);
  for (std::size_t i = 1; i < alarms.size(); ++i) {
    EXPECT_LE(alarms[i - 1].line, alarms[i].line) << alarms[i - 1].id << " " << alarms[i].id;
  }
  EXPECT_EQ(alarms.front().line, 6U);
  EXPECT_EQ(alarms.front().id, "PS1008");
}

// --- the rules of Mitsubishi
// ----------------------------------------------------------------------

struct MitsubishiAlarm {
  const char* name;
  const char* text;
  std::vector<std::string> alarms;
};

class MitsubishiAlarms : public testing::TestWithParam<MitsubishiAlarm> {};

TEST_P(MitsubishiAlarms, AreThoseOfItsManual) {
  EXPECT_EQ(curve_tests::short_forms(
                nurbs_alarms(parsed(GetParam().text), mitsubishi_nurbs(Units::kMillimetre))),
            GetParam().alarms);
}

INSTANTIATE_TEST_SUITE_P(
    Nurbs, MitsubishiAlarms,
    testing::Values(
        MitsubishiAlarm{
            "None", "G5P10000\nG06.2 K0 X0 Y0 Z0\nK0 X1\nK0 X2\nK0 X3\nK1\nK1\nK1\nK1\nG5P0\n", {}},
        MitsubishiAlarm{
            "NoFrame", "G06.2 K0 X0 Y0 Z0\nK0 X1\nK0 X2\nK0 X3\nK1\nK1\nK1\nK1\n", {"1 frame"}},
        MitsubishiAlarm{"TwoAxes",
                        "G5P10000\nG06.2 K0 X0 Y0\nK0 X1\nK0 X2 Z1\nK0 X3\nK1\nK1\nK1\nK1\nG5P0\n",
                        {"2 P32", "4 P32"}},
        MitsubishiAlarm{"FiveDecimals",
                        "G5P10000\nG06.2 K0 X0 Y0 Z0\nK0 X1\nK0 X2 R1.00001\nK0 X3\nK1.00001 X4\n"
                        "K2\nK2\nK2\nK2\nG5P0\n",
                        {"4 P33", "6 P33"}},
        MitsubishiAlarm{"KnotDecreases",
                        "G5P10000\nG06.2 K0 X0 Y0 Z0\nK0 X1\nK0 X2\nK0 X3\nK1 X4\nK.5 X5\n"
                        "K2\nK2\nK2\nK2\nG5P0\n",
                        {"7 P551"}},
        MitsubishiAlarm{"MissingKnot",
                        "G5P10000\nG06.2 K0 X0 Y0 Z0\nX1\nK0 X2\nK0 X3\nK1\nK1\nK1\nK1\nG5P0\n",
                        {"3 P33"}},
        MitsubishiAlarm{
            "UnderG41",
            "G41 D1\nG5P10000\nG06.2 K0 X0 Y0 Z0\nK0 X1\nK0 X2\nK0 X3\nK1\nK1\nK1\nK1\n",
            {"3 P29"}}),
    [](const auto& test) { return std::string(test.param.name); });

class NurbsUnderModes : public testing::TestWithParam<std::pair<const char*, bool>> {};

TEST_P(NurbsUnderModes, GivePs1006) {
  const auto& [modes, alarm] = GetParam();
  const Program program = parsed(std::string(modes) + "\n" + kGolden + "G01\n");
  EXPECT_EQ(curve_tests::short_forms(nurbs_alarms(program, fanuc())),
            alarm ? std::vector<std::string>{"2 PS1006"} : std::vector<std::string>{});
}

INSTANTIATE_TEST_SUITE_P(Nurbs, NurbsUnderModes,
                         testing::Values(std::pair("G41 D1", true), std::pair("G42", true),
                                         std::pair("G93", true), std::pair("G95", true),
                                         std::pair("G12.1", true), std::pair("G41 G40", false),
                                         std::pair("G94 G90 G54", false)));

}  // namespace
}  // namespace batten::gcode
