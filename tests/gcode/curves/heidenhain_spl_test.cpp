#include "gcode/curves/heidenhain_spl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "gcode/curves/curve_print.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/curve_texts.h"
#include "tests/support/klartext_arc_alarms.h"
#include "tests/support/spl_alarms.h"

namespace batten::gcode {
namespace {

using curve_tests::curve_of;
using curve_tests::reading_of;
using curve_tests::refusal_of;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Point3;

CurveSetting heidenhain_setting() {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 6};
  setting.feeds = {.decimals = 3};
  return setting;
}

CurveSetting golden_spl_setting() {
  CurveSetting setting = heidenhain_setting();
  setting.axes = {true, true, false};
  setting.feed = 3000;
  return setting;
}

Program parsed_klartext(const std::string& text) {
  return curve_tests::parsed(text, Language::kKlartext);
}

std::string spl(const BsplineCurve& curve, const CurveSetting& setting) {
  return text_of(heidenhain_spl().write(curve, setting));
}

CurveAlarms alarms_of(const std::string& text) {
  return spl_alarms(parsed_klartext(text), Units::kMillimetre);
}

// --- samples of the maker ------------------------------------------------------------------------

// iTNC 530 user manual 60642x-04, p. 539: two blocks in three axes.
constexpr const char* kManual =
    "7 L X+28.338 Y+19.385 Z-0.5 FMAX\n"
    "8 SPL X24.875 Y15.924 Z-0.5\n"
    "K3X-4.688E-002 K2X2.459E-002 K1X3.486E+000\n"
    "K3Y-4.563E-002 K2Y2.155E-002 K1Y3.486E+000\n"
    "K3Z0.000E+000 K2Z0.000E+000 K1Z0.000E+000 F10000\n"
    "9 SPL X17.952 Y9.003 Z-0.500\n"
    "K3X5.159E-002 K2X-5.644E-002 K1X6.928E+000\n"
    "K3Y3.753E-002 K2Y-2.644E-002 K1Y6.910E+000\n"
    "K3Z0.000E+000 K2Z0.000E+000 K1Z0.000E+000\n";

TEST(Spl, ReadsTheSampleOfTheManual) {
  const Point3 start(28.338, 19.385, -0.5);
  const CurveReading reading =
      reading_of(heidenhain_spl().read(parsed_klartext(kManual), 1, starting_at(start)));
  ASSERT_EQ(reading.motions.size(), 2U);
  EXPECT_EQ(reading.blocks, 8U);
  EXPECT_EQ(reading.feed, 10000);
  const auto pieces = curve_tests::beziers_of(reading);
  const geometry::Vector3 first = pieces[0].control[0] - start;
  const geometry::Vector3 second = pieces[1].control[0] - pieces[0].control[3];
  // Sums of the printed numbers: 0.71 and 0.92 um, then 0.15 and 0.09 um.
  EXPECT_NEAR(first.x(), 0.00071, 1e-9);
  EXPECT_NEAR(first.y(), 0.00092, 1e-9);
  EXPECT_NEAR(second.x(), 0.00015, 1e-9);
  EXPECT_NEAR(second.y(), 0.00009, 1e-9);
  const double kink = kink_between(pieces[0], pieces[1]);
  EXPECT_NEAR(kink * 180 / std::numbers::pi, 0.0007, 0.00005);
  EXPECT_EQ(curve_tests::short_forms(alarms_of(kManual)), std::vector<std::string>{});
}

// The same manual's sample in five axes does not close, and misprints K1Y: it is no curve.
TEST(Spl, RefusesTheSampleOfTheManualThatDoesNotClose) {
  const std::string sample =
      "7 L X+33.909 Y-25.838 Z+75.107 A+17 B-10.103 FMAX\n"
      "8 SPL X+39.824 Y-28.378 Z+77.425 A+17.32 B-12.75\n"
      "K3X+0.0983 K2X-0.441 K1X-5.5724\n"
      "K3Y-0.0422 K2Y+0.1893 K1Y+2.3929\n"
      "K3Z+0.0015 K2Z-0.9549 K1Z+3.0875\n"
      "K3A+0.1283 K2A-0.141 K1A-0.5724\n"
      "K3B+0.0083 K2B-0.413 E+2 K1B-1.5724 E+1 F10000\n";
  EXPECT_EQ(curve_tests::short_forms(alarms_of(sample)),
            (std::vector<std::string>{"2 spl-closure", "2 spl-closure", "2 spl-closure"}));
  EXPECT_EQ(refusal_of(heidenhain_spl().read(parsed_klartext(sample), 1,
                                             starting_at(Point3(33.909, -25.838, 75.107)))),
            "an SPL block that is not understood");
}

// --- numbers -------------------------------------------------------------------------------------

struct Coefficient {
  double value;
  int decimals;
  const char* digits;
};

class SplCoefficients : public testing::TestWithParam<Coefficient> {};

TEST_P(SplCoefficients, FollowTheRuleOfTheExponent) {
  const auto& [value, decimals, digits] = GetParam();
  const auto printed = print_spl_coefficient(value, decimals);
  ASSERT_TRUE(printed);
  EXPECT_EQ(printed->digits, digits);
  const auto line = read_klartext_line("K1X" + printed->digits);
  ASSERT_TRUE(line);
  EXPECT_EQ(line->words[0].value, printed->value);
  EXPECT_LE(std::abs(line->words[0].mantissa), 9.99999999);
  EXPECT_LE(line->words[0].decimals, 8);
}

INSTANTIATE_TEST_SUITE_P(
    Spl, SplCoefficients,
    testing::Values(Coefficient{0, 6, "+0"}, Coefficient{-0.0000001, 6, "+0"},
                    Coefficient{5.6, 6, "+5.6"}, Coefficient{-0.0468812, 6, "-0.046881"},
                    Coefficient{9.99999999, 8, "+9.99999999"}, Coefficient{9.9999999, 6, "+1E+001"},
                    Coefficient{10, 6, "+1E+001"}, Coefficient{-12, 6, "-1.2E+001"},
                    Coefficient{12.3456789, 6, "+1.2345679E+001"},
                    Coefficient{99.9999999, 6, "+1E+002"},
                    Coefficient{1234.5678912, 8, "+1.23456789E+003"}));

TEST(KlartextLine, IsReadAsTheManualsPrintIt) {
  const auto line = read_klartext_line("8 SPL X24,875 Y+15.924 K2B-0.413 E+2 F100 M3 RL FMAX ~ ");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->number, 8);
  EXPECT_TRUE(line->continues);
  ASSERT_EQ(line->words.size(), 8U);
  EXPECT_EQ(line->words[1].value, 24.875);
  EXPECT_EQ(line->words[3].name, "K2B");
  EXPECT_DOUBLE_EQ(*line->words[3].value, -41.3);
  EXPECT_EQ(line->words[3].exponent, 2);
  EXPECT_EQ(line->words[6].name, "RL");
  EXPECT_FALSE(line->words[7].value);
  for (const char* bad :
       {"8 SPL X+", "8 L X+1 1Y+2", "8 SPL ~ X+1", "L \"T\"", "K1X+E2", "L X+1000000000"}) {
    EXPECT_FALSE(read_klartext_line(bad)) << bad;
  }
}

// --- rounding -----------------------------------------------------------------------------------

TEST(Spl, TakesMoreDigitsWhereAJointWouldHaveAKink) {
  // Two pieces of 0.03 mm: a coefficient that is off by 0.0005 turns the joint by half a degree.
  const CubicBezier first{{{0, 0, 0}, {0.0101, 0.0023, 0}, {0.0199, 0.0049, 0}, {0.03, 0.008, 0}}};
  const geometry::Vector3 leg = first.control[3] - first.control[2];
  const Point3 joint = first.control[3];
  const CubicBezier second{
      {joint, joint + leg, joint + Point3(0.0197, 0.0071, 0), joint + Point3(0.029, 0.011, 0)}};
  CurveSetting setting = heidenhain_setting();
  setting.axes = {true, true, false};
  setting.other.decimals = 3;
  const std::string text = spl(curve_of({first, second}), setting);
  EXPECT_EQ(curve_tests::short_forms(alarms_of("1 L X+0 Y+0\n" + text)),
            std::vector<std::string>{});
  // The same a hundred thousand times as small: eight decimals are not enough.
  CubicBezier small_first = first;
  CubicBezier small_second = second;
  for (int i = 0; i < 4; ++i) {
    small_first.control[i] *= 1e-5;
    small_second.control[i] *= 1e-5;
  }
  setting.places.decimals = 9;
  setting.other.decimals = 8;
  EXPECT_EQ(spl(curve_of({small_first, small_second}), setting),
            "rounding bends a joint by 0.1 degrees or more");
}

TEST(Spl, WritesInches) {
  CurveSetting setting = golden_spl_setting();
  setting.units = Units::kInch;
  setting.feed = 254;
  const CubicBezier piece{{{0, 0, 0}, {25.4, 0, 0}, {50.8, 25.4, 0}, {50.8, 50.8, 0}}};
  const std::string text = spl(curve_of({piece}), setting);
  // In inches (0,0) (1,0) (2,1) (2,2): K3 = b0 - 3 b1 + 3 b2 - b3, K2 = 3 (b1 - 2 b2 + b3), K1 =
  // 3 (b2 - b3).
  EXPECT_EQ(text, "SPL X+2 Y+2 ~\n  K3X+1 K2X-3 K1X+0 ~\n  K3Y+1 K2Y+0 K1Y-3 F10\n");
  const auto result =
      heidenhain_spl().read(parsed_klartext(text), 0, starting_at(Point3::Zero(), Units::kInch));
  EXPECT_LT(greatest_move(std::vector{piece}, curve_tests::beziers_of(reading_of(result))), 1e-9);
}

// --- refusals ------------------------------------------------------------------------------------

TEST(Spl, RefusesWhatItCannotSay) {
  const BsplineCurve curve = curve_tests::golden_curve();
  CurveSetting one_axis = golden_spl_setting();
  one_axis.axes = {true, false, false};
  EXPECT_EQ(spl(curve, one_axis), "SPL names two axes or more");
  CurveSetting elsewhere = golden_spl_setting();
  elsewhere.start = {0.01, 0, 0};
  EXPECT_EQ(spl(curve, elsewhere), "the curve does not start at the tool's position");
  const CubicBezier far{{{0, 0, 0}, {4e4, 0, 0}, {8e4, 1, 0}, {1.2e5, 2, 0}}};
  EXPECT_EQ(spl(curve_of({far}), golden_spl_setting()), "a position beyond 99999.9999");
}

// --- alarms --------------------------------------------------------------------------------------

struct SplTextCase {
  const char* name;
  const char* text;
  std::vector<std::string> alarms;
};

class SplTexts : public testing::TestWithParam<SplTextCase> {};

TEST_P(SplTexts, GiveTheirAlarms) {
  EXPECT_EQ(curve_tests::short_forms(alarms_of(GetParam().text)), GetParam().alarms);
}

INSTANTIATE_TEST_SUITE_P(
    Spl, SplTexts,
    testing::Values(
        SplTextCase{"Straight",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                    {}},
        SplTextCase{"OneMicrometreAndMoreOff",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-2.9989 ~\n"
                    " K3Y+0 K2Y+0 K1Y+0.0009\n",
                    {"2 spl-closure"}},
        SplTextCase{"NoLineBefore",
                    "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                    {"1 spl-first"}},
        SplTextCase{"WrongOrder",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K1X-3 K2X+0 K3X+0 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                    {"2 spl-order"}},
        SplTextCase{
            "MissingAxis", "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3\n", {"2 spl-order"}},
        SplTextCase{"AxisTwice",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3X+0 K2X+0 K1X-3\n",
                    {"2 spl-order"}},
        SplTextCase{"OneAxis", "1 L X+0 Y+0\n2 SPL X+3 ~\n K3X+0 K2X+0 K1X-3\n", {"2 spl-axes"}},
        SplTextCase{"CoefficientWithoutExponent",
                    "1 L X+0 Y+0\n2 SPL X+30 Y+0 ~\n K3X+0 K2X+0 K1X-30 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                    {"2 spl-coefficient"}},
        SplTextCase{"NineDecimals",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n"
                    " K3Y+0 K2Y+0.000000001 K1Y+0\n",
                    {"2 spl-coefficient"}},
        SplTextCase{"ExponentTooGreat",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n"
                    " K3Y+1E-256 K2Y+0 K1Y+0\n",
                    {"2 spl-exponent"}},
        SplTextCase{"EndTooFar",
                    "1 L X+100000 Y+0\n2 SPL X+100003 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n"
                    " K3Y+0 K2Y+0 K1Y+0\n",
                    {"2 spl-end"}},
        SplTextCase{"OtherWords",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 RL ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                    {"2 spl-words"}},
        // The directions are (1, 0) and (1, 0.0018): 0.103 degrees.
        SplTextCase{"Kink",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n"
                    "3 SPL X+4 Y+0.0018 ~\n K3X+0 K2X+0 K1X-1 ~\n K3Y+0 K2Y+0 K1Y-0.0018\n",
                    {"5 spl-kink"}},
        // 0.097 degrees.
        SplTextCase{"SmallKink",
                    "1 L X+0 Y+0\n2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0\n"
                    "3 SPL X+4 Y+0.0017 ~\n K3X+0 K2X+0 K1X-1 ~\n K3Y+0 K2Y+0 K1Y-0.0017\n",
                    {}}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(KlartextArcAlarms, AreGivenForArcsThatAreNone) {
  const std::string text =
      "1 L X+0 Y+0\n"
      "2 C X+1 Y+1 DR+\n"
      "3 CC X+5 Y+0\n"
      "4 C X+10 Y+0.5\n"
      "5 L X+0 Y+0\n"
      "6 C X+10.015 Y+0 DR+\n"
      "7 L X+0 Y+0\n"
      "8 C X+10.017 Y+0 DR+\n"
      "9 L X+100000\n";
  EXPECT_EQ(
      curve_tests::short_forms(klartext_arc_alarms(parsed_klartext(text), Units::kMillimetre)),
      (std::vector<std::string>{"2 arc-no-centre", "4 arc-no-sense", "4 arc-radius", "8 arc-radius",
                                "9 place-range"}));
}

struct SplRefusal {
  const char* name;
  const char* text;
  const char* why;
};

class SplRefusals : public testing::TestWithParam<SplRefusal> {};

TEST_P(SplRefusals, AreSaid) {
  EXPECT_EQ(refusal_of(heidenhain_spl().read(parsed_klartext(GetParam().text), 0,
                                             starting_at(Point3::Zero()))),
            GetParam().why);
}

INSTANTIATE_TEST_SUITE_P(
    Spl, SplRefusals,
    testing::Values(SplRefusal{"NoSpline", "1 L X+0 Y+0\n", "no SPL"},
                    SplRefusal{"OneMicrometreAndMoreOff",
                               "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-2.9989 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                               "a spline that starts 1 um or more from the tool's position"},
                    SplRefusal{"RotaryAxis",
                               "2 SPL X+3 A+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3A+0 K2A+0 K1A+0\n",
                               "an SPL block that is not understood"},
                    SplRefusal{"MissingCoefficient",
                               "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0\n",
                               "an SPL block that is not understood"},
                    SplRefusal{"EndOfProgram", "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n",
                               "an SPL block that is not understood"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Spl, AFeedOfItsOwnEndsACurve) {
  const std::string block = "SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0 F5\n";
  const std::string next = "SPL X+6 Y+0 ~\n K3X+0 K2X+0 K1X-3 ~\n K3Y+0 K2Y+0 K1Y+0 F6\n";
  const CurveReading reading = reading_of(
      heidenhain_spl().read(parsed_klartext(block + next), 0, starting_at(Point3::Zero())));
  EXPECT_EQ(reading.blocks, 3U);
  EXPECT_EQ(reading.motions.size(), 1U);
}

}  // namespace
}  // namespace batten::gcode
