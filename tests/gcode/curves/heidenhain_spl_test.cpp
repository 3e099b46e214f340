#include "gcode/curves/heidenhain_spl.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/klartext_words.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/curve_texts.h"
#include "tests/support/spl_alarms.h"

namespace batten::gcode {
namespace {

using curve_tests::parsed;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Point3;

constexpr std::uint32_t kProvedSeeds = 5;

CurveSetting heidenhain_setting() {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 6};
  setting.feeds = {.decimals = 3};
  return setting;
}

CurveSetting golden_setting() {
  CurveSetting setting = heidenhain_setting();
  setting.axes = {true, true, false};
  setting.feed = 3000;
  return setting;
}

std::string refusal_of(const CurveResult& result) {
  const auto* refusal = std::get_if<CurveRefusal>(&result);
  return refusal != nullptr ? refusal->why : "";
}

SplText spl_of(const std::string& text, std::uint32_t first, const Point3& start) {
  auto read = read_spl_text(parsed(text), first, starting_at(start));
  if (const auto* refusal = std::get_if<CurveRefusal>(&read)) {
    ADD_FAILURE() << refusal->why << "\n" << text;
    return {};
  }
  return std::get<SplText>(std::move(read));
}

CurveAlarms alarms_of(const std::string& text) {
  return spl_alarms(parsed(text), Units::kMillimetre);
}

// --- the golden curve
// -----------------------------------------------------------------------------

constexpr const char* kGolden =
    "8 SPL X+18 Y+6.4 ~\n"
    "  K3X-6 K2X+0 K1X-1.2E+001 ~\n"
    "  K3Y+5.6 K2Y-4.8 K1Y-7.2 F3000\n"
    "9 SPL X+40 Y+0 ~\n"
    "  K3X-4 K2X+1.2E+001 K1X-3E+001 ~\n"
    "  K3Y+6.4 K2Y-3E+001 K1Y+3E+001\n";

TEST(Spl, WritesTheGoldenCurve) {
  EXPECT_EQ(text_of(write_spl(curve_tests::golden_curve().bezier_pieces(), golden_setting(),
                              {.first_number = 8})),
            kGolden);
}

TEST(Spl, WritesNoNumbersWhereNoneAreAskedFor) {
  const std::string text =
      text_of(write_spl(curve_tests::golden_curve().bezier_pieces(), golden_setting(), {}));
  EXPECT_EQ(text.substr(0, text.find('\n')), "SPL X+18 Y+6.4 ~");
}

TEST(Spl, ReadsTheGoldenCurveAtItsFiveValues) {
  const SplText text =
      spl_of("7 L X+0 Y+0 F3000\n" + std::string(kGolden) + "10 L X+50\n", 1, Point3::Zero());
  ASSERT_EQ(text.pieces.size(), 2U);
  EXPECT_EQ(text.blocks, 6U);
  EXPECT_EQ(text.pieces[0].feed, 3000);
  EXPECT_EQ(text.pieces[1].block, 4U);
  for (const auto& [u, x, y] : curve_tests::kGoldenValues) {
    // t runs from 1 to 0.
    const Point3 at = u <= 0.4 ? text.pieces[0].point_at(1 - u / 0.4)
                               : text.pieces[1].point_at(1 - (u - 0.4) / 0.6);
    EXPECT_LT((at - Point3(x, y, 0)).norm(), 1e-12) << u;
  }
  EXPECT_EQ(curve_tests::short_forms(alarms_of("7 L X+0 Y+0 F3000\n" + std::string(kGolden))),
            std::vector<std::string>{});
}

// --- samples of the maker
// -------------------------------------------------------------------------

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
  const SplText text = spl_of(kManual, 1, Point3(28.338, 19.385, -0.5));
  ASSERT_EQ(text.pieces.size(), 2U);
  EXPECT_EQ(text.blocks, 8U);
  EXPECT_EQ(text.pieces[0].feed, 10000);
  const geometry::Vector3 first = text.pieces[0].point_at(1) - Point3(28.338, 19.385, -0.5);
  const geometry::Vector3 second = text.pieces[1].point_at(1) - text.pieces[0].end;
  // Sums of the printed numbers: 0.71 and 0.92 um, then 0.15 and 0.09 um.
  EXPECT_NEAR(first.x(), 0.00071, 1e-9);
  EXPECT_NEAR(first.y(), 0.00092, 1e-9);
  EXPECT_NEAR(second.x(), 0.00015, 1e-9);
  EXPECT_NEAR(second.y(), 0.00009, 1e-9);
  const double kink = kink_between(text.pieces[0].piece(), text.pieces[1].piece());
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
  EXPECT_EQ(refusal_of(read_spl(parsed(sample), 1, starting_at(Point3(33.909, -25.838, 75.107)))),
            "an SPL block that is not understood");
}

// --- numbers
// --------------------------------------------------------------------------------------

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

// --- random curves
// --------------------------------------------------------------------------------

TEST(Spl, RandomCurvesAreReadWithinTheirRounding) {
  // Ends move by half a step on every axis. K3 and K2 by half of one of theirs, and K1 by what both
  // leave: the inner control points by (K2 + 2 K3) / 3 at the most, as for POLY.
  const double within = std::sqrt(3.0) * (0.5e-4 + 0.5e-6);
  double worst = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const bool in_space = seed % 2 != 0;
    const BsplineCurve curve = curve_tests::random_curve(seed, in_space);
    CurveSetting setting = heidenhain_setting();
    setting.start = curve.control_points().front();
    setting.axes = {true, true, in_space};
    const std::vector<CubicBezier> pieces = curve.bezier_pieces();
    const std::string text = text_of(write_spl(pieces, setting, {.first_number = 2}));
    const std::string line = "1 L X" + to_text(setting.start.x(), {.decimals = 3}) + " Y" +
                             to_text(setting.start.y(), {.decimals = 3}) + " Z-1.5 F100\n";
    int corners = 0;
    for (std::size_t i = 1; i < pieces.size(); ++i) {
      corners += kink_between(pieces[i - 1], pieces[i]) >= kSplKink ? 1 : 0;
    }
    const CurveAlarms alarms = alarms_of(line + text);
    EXPECT_EQ(std::ranges::count(alarms, std::string_view("spl-kink"), &CurveAlarm::id), corners);
    EXPECT_EQ(alarms.size(), static_cast<std::size_t>(corners)) << text;
    const auto result = read_spl(parsed(line + text), 1, starting_at(setting.start));
    ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << refusal_of(result) << text;
    const auto& reading = std::get<CurveReading>(result);
    EXPECT_EQ(reading.blocks, curve_tests::lines_in(text));
    EXPECT_EQ(reading.axes, setting.axes);
    const auto read = curve_tests::beziers_of(reading);
    EXPECT_EQ(read[0].control[0], setting.start);
    for (std::size_t i = 1; i < read.size(); ++i) {
      EXPECT_EQ(read[i].control[0], read[i - 1].control[3]) << "blocks that do not close";
    }
    const double move = greatest_move(pieces, read);
    EXPECT_LE(move, within);
    worst = std::max(worst, move);
    if (seed >= kProvedSeeds) continue;
    EXPECT_EQ(geometry::compare_paths(curve_tests::pieces_of(curve),
                                      curve_tests::pieces_of(reading), 1e-3)
                  .verdict,
              geometry::Verdict::kProved);
  }
  EXPECT_GT(worst, 0.1 * within) << "nothing was rounded";
}

TEST(Spl, TooFewDigitsAreARefusalOrADeviation) {
  int refused = 0;
  int off = 0;
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    const BsplineCurve curve = curve_tests::random_curve(seed, true);
    CurveSetting setting = heidenhain_setting();
    setting.start = curve.control_points().front();
    const CurveWriting writing =
        write_spl(curve.bezier_pieces(), setting, {.max_decimals = 1, .first_number = {}});
    if (std::holds_alternative<CurveRefusal>(writing)) {
      ++refused;
      continue;
    }
    const auto result = read_spl(parsed(text_of(writing)), 0, starting_at(setting.start));
    ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << refusal_of(result);
    const auto pieces = curve_tests::pieces_of(std::get<CurveReading>(result));
    off += geometry::compare_paths(curve_tests::pieces_of(curve), pieces, 0.01).verdict ==
                   geometry::Verdict::kBroken
               ? 1
               : 0;
  }
  EXPECT_EQ(refused + off, 50);
  EXPECT_GT(refused, 0);
}

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
  const std::vector<CubicBezier> pieces = {first, second};
  const std::string text = text_of(write_spl(pieces, setting, {.first_number = 2}));
  EXPECT_EQ(curve_tests::short_forms(alarms_of("1 L X+0 Y+0\n" + text)),
            std::vector<std::string>{});
  EXPECT_EQ(text_of(write_spl(pieces, setting, {.max_decimals = 3, .first_number = {}})),
            "rounding makes a kink of 0.1 degrees or more");
}

TEST(Spl, WritesInches) {
  CurveSetting setting = golden_setting();
  setting.units = Units::kInch;
  setting.feed = 254;
  const CubicBezier piece{{{0, 0, 0}, {25.4, 0, 0}, {50.8, 25.4, 0}, {50.8, 50.8, 0}}};
  const std::string text = text_of(write_spl(std::vector{piece}, setting, {}));
  // In inches (0,0) (1,0) (2,1) (2,2): K3 = b0 - 3 b1 + 3 b2 - b3, K2 = 3 (b1 - 2 b2 + b3), K1 =
  // 3 (b2 - b3).
  EXPECT_EQ(text, "SPL X+2 Y+2 ~\n  K3X+1 K2X-3 K1X+0 ~\n  K3Y+1 K2Y+0 K1Y-3 F10\n");
  const auto result = read_spl(parsed(text), 0, starting_at(Point3::Zero(), Units::kInch));
  EXPECT_LT(
      greatest_move(std::vector{piece}, curve_tests::beziers_of(std::get<CurveReading>(result))),
      1e-9);
}

// --- refusals
// -------------------------------------------------------------------------------------

TEST(Spl, RefusesWhatItCannotSay) {
  const auto pieces = curve_tests::golden_curve().bezier_pieces();
  EXPECT_EQ(text_of(write_spl({}, golden_setting(), {})), "no curve");
  CurveSetting one_axis = golden_setting();
  one_axis.axes = {true, false, false};
  EXPECT_EQ(text_of(write_spl(pieces, one_axis, {})), "SPL names two axes or more");
  CurveSetting elsewhere = golden_setting();
  elsewhere.start = {0.01, 0, 0};
  EXPECT_EQ(text_of(write_spl(pieces, elsewhere, {})),
            "the curve does not start where the tool stands");
  const CubicBezier far{{{0, 0, 0}, {4e4, 0, 0}, {8e4, 1, 0}, {1.2e5, 2, 0}}};
  EXPECT_EQ(text_of(write_spl(std::vector{far}, golden_setting(), {})),
            "a place beyond 99999.9999");
}

struct SplState {
  const char* name;
  void (*change)(ModalState&);
};

class SplStates : public testing::TestWithParam<SplState> {};

TEST_P(SplStates, AreComplainedAbout) {
  ModalState state;
  EXPECT_EQ(spl_complaint(state), "");
  GetParam().change(state);
  EXPECT_NE(spl_complaint(state), "");
}

INSTANTIATE_TEST_SUITE_P(
    Spl, SplStates,
    testing::Values(
        SplState{"RL", [](ModalState& s) { s.cutter_compensation = TriState::kOn; }},
        SplState{"Incremental", [](ModalState& s) { s.distance = DistanceMode::kIncremental; }},
        SplState{"M128", [](ModalState& s) { s.tool_center_point = TriState::kUnknown; }},
        SplState{"Mirror", [](ModalState& s) { s.mirror = TriState::kOn; }},
        SplState{"Plane", [](ModalState& s) { s.tilted_plane = TriState::kOn; }}),
    [](const auto& test) { return std::string(test.param.name); });

// --- alarms
// ---------------------------------------------------------------------------------------

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

struct SplRefusal {
  const char* name;
  const char* text;
  const char* why;
};

class SplRefusals : public testing::TestWithParam<SplRefusal> {};

TEST_P(SplRefusals, AreSaid) {
  EXPECT_EQ(refusal_of(read_spl(parsed(GetParam().text), 0, starting_at(Point3::Zero()))),
            GetParam().why);
}

INSTANTIATE_TEST_SUITE_P(
    Spl, SplRefusals,
    testing::Values(SplRefusal{"NoSpline", "1 L X+0 Y+0\n", "no SPL"},
                    SplRefusal{"OneMicrometreAndMoreOff",
                               "2 SPL X+3 Y+0 ~\n K3X+0 K2X+0 K1X-2.9989 ~\n K3Y+0 K2Y+0 K1Y+0\n",
                               "a spline that starts 1 um or more from where the tool stands"},
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
  const SplText text = spl_of(block + next, 0, Point3::Zero());
  EXPECT_EQ(text.blocks, 3U);
  EXPECT_EQ(text.pieces.size(), 1U);
}

}  // namespace
}  // namespace batten::gcode
