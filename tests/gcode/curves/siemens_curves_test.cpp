#include "gcode/curves/siemens_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "gcode/curves/curve_print.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/curve_texts.h"
#include "tests/support/poly_alarms.h"

namespace batten::gcode {
namespace {

using curve_tests::curve_of;
using curve_tests::parsed;
using curve_tests::reading_of;
using curve_tests::refusal_of;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Point3;

CurveSetting siemens_setting() {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 6};
  setting.feeds = {.decimals = 3};
  return setting;
}

CurveSetting golden_poly_setting() {
  CurveSetting setting = siemens_setting();
  setting.axes = {true, true, false};
  return setting;
}

std::string poly(const BsplineCurve& curve, const CurveSetting& setting) {
  return text_of(siemens_poly().write(curve, setting));
}

CurveResult read_poly(const std::string& text, const Point3& start = Point3::Zero()) {
  return siemens_poly().read(parsed(text), 0, starting_at(start));
}

// --- what is written ----------------------------------------------------------------------------

TEST(Poly, SaysTheFeedInTheFirstBlock) {
  CurveSetting setting = golden_poly_setting();
  setting.feed = 1200;
  const std::string text = poly(curve_tests::golden_curve(), setting);
  EXPECT_EQ(text,
            "POLY PO[X]=(18,-18,6) PO[Y]=(6.4,12,-5.6) F1200\n"
            "PO[X]=(40,0,4) PO[Y]=(0,-10.8,-6.4)\n");
  EXPECT_EQ(reading_of(read_poly(text)).feed, 1200);
}

TEST(Poly, LeavesOutZerosAtTheEnd) {
  const CubicBezier line{{{0, 0, 0}, {1, 2, 0}, {2, 4, 0}, {3, 6, 0}}};
  EXPECT_EQ(poly(curve_of({line}), golden_poly_setting()), "POLY PO[X]=(3) PO[Y]=(6)\n");
}

// --- samples of the maker -----------------------------------------------------------------------

// Programming guide 840D advanced 04.00, p. 5-167: a quarter circle as a quotient.
TEST(Poly, RefusesTheQuarterCircleOfTheManual) {
  const std::string sample =
      "POLY G90 X10 Y0 F100\n"
      "PO[X]=(0,-10) PO[Y]=(10) PO[]=(2,1)\n";
  EXPECT_EQ(curve_tests::short_forms(poly_alarms(parsed(sample))), std::vector<std::string>{});
  EXPECT_EQ(refusal_of(read_poly(sample)),
            "a polynomial that is rational or above the third degree");
  const CurveReading line = reading_of(read_poly("POLY G90 X10 Y0 F100\nPO[X]=(4) PO[]=(1)\n"));
  ASSERT_EQ(line.motions.size(), 2U);
  EXPECT_EQ(line.feed, 100);
  EXPECT_TRUE(std::holds_alternative<geometry::Line>(line.motions[0].piece));
}

// The same guide, p. 5-165, its places given: PL, a straight axis beside a curved one.
TEST(Poly, ReadsTheSampleWithIntervals) {
  const std::string sample =
      "N11 POLY PO[X]=(1,2.5,0.7) PO[Y]=(0.3,1,3.2) PL=1.5\n"
      "N12 PO[X]=(0,2.5,1.7) PO[Y]=(2.3,1.7) PL=3\n"
      "N25 X70 PO[Y]=(9.3,1,7.67) PL=5\n"
      "N30 G1 X0 Y0 Z0\n";
  EXPECT_EQ(curve_tests::short_forms(poly_alarms(parsed(sample))), std::vector<std::string>{});
  const CurveReading reading = reading_of(read_poly(sample));
  ASSERT_EQ(reading.motions.size(), 3U);
  EXPECT_EQ(reading.blocks, 3U);
  const auto at = [&](std::size_t piece, double p, double length) {
    return geometry::point_at(reading.motions[piece].piece, p / length);
  };
  // p = 0.5 of N11: a1 = (1 - 2.5 * 2.25 - 0.7 * 3.375) / 1.5.
  const double a1 = (1 - 2.5 * 2.25 - 0.7 * 3.375) / 1.5;
  EXPECT_NEAR(at(0, 0.5, 1.5).x(), 0.5 * a1 + 2.5 * 0.25 + 0.7 * 0.125, 1e-12);
  EXPECT_LT((at(0, 1.5, 1.5) - Point3(1, 0.3, 0)).norm(), 1e-12);
  EXPECT_LT((at(1, 0, 3) - Point3(1, 0.3, 0)).norm(), 1e-12);
  // Straight in X: halfway at half the interval.
  EXPECT_NEAR(at(2, 2.5, 5).x(), 35, 1e-9);
  EXPECT_LT((at(2, 5, 5) - Point3(70, 9.3, 0)).norm(), 1e-9);
}

// --- rounding -----------------------------------------------------------------------------------

TEST(Poly, RoundedEndsMakeNoKinks) {
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = curve_tests::random_curve(seed, true);
    CurveSetting setting = siemens_setting();
    setting.start = curve.control_points().front();
    const std::vector<CubicBezier> pieces = curve.bezier_pieces();
    const auto read =
        curve_tests::beziers_of(reading_of(read_poly(poly(curve, setting), setting.start)));
    for (std::size_t i = 1; i < read.size(); ++i) {
      EXPECT_EQ(read[i].control[0], read[i - 1].control[3]) << "blocks that do not chain";
      // Half a step e of a2 and a3 changes the derivative at the end by 3 e, at the start by
      // 2 e, on every axis.
      const double arriving = 3 * (pieces[i - 1].control[3] - pieces[i - 1].control[2]).norm();
      const double leaving = 3 * (pieces[i].control[1] - pieces[i].control[0]).norm();
      const double turn = std::sqrt(3.0) * 0.5e-6 * (3 / arriving + 2 / leaving);
      EXPECT_LE(kink_between(read[i - 1], read[i]),
                kink_between(pieces[i - 1], pieces[i]) + turn + 1e-9);
    }
  }
}

TEST(Poly, TooFewDigitsAreADeviation) {
  int off = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const BsplineCurve curve = curve_tests::random_curve(seed, true);
    CurveSetting setting = siemens_setting();
    setting.start = curve.control_points().front();
    setting.other = {.decimals = 0};
    const auto pieces =
        curve_tests::pieces_of(reading_of(read_poly(poly(curve, setting), setting.start)));
    off += geometry::compare_paths(curve_tests::pieces_of(curve), pieces, 0.01).verdict ==
                   geometry::Verdict::kBroken
               ? 1
               : 0;
  }
  EXPECT_EQ(off, 20);
}

TEST(Poly, WritesInches) {
  CurveSetting setting = golden_poly_setting();
  setting.units = Units::kInch;
  const CubicBezier piece{{{0, 0, 0}, {25.4, 0, 0}, {50.8, 25.4, 0}, {50.8, 50.8, 0}}};
  const std::string text = poly(curve_of({piece}), setting);
  // In inches (0,0) (1,0) (2,1) (2,2): a2 = 3 (b0 - 2 b1 + b2), a3 = b3 - 3 b2 + 3 b1 - b0.
  EXPECT_EQ(text, "POLY PO[X]=(2,0,-1) PO[Y]=(2,3,-1)\n");
  const auto result =
      siemens_poly().read(parsed(text), 0, starting_at(Point3::Zero(), Units::kInch));
  EXPECT_LT(greatest_move(std::vector{piece}, curve_tests::beziers_of(reading_of(result))), 1e-9);
}

// --- refusals and alarms -------------------------------------------------------------------------

TEST(Poly, RefusesACurveThatStartsElsewhere) {
  CurveSetting elsewhere = golden_poly_setting();
  elsewhere.start = {0.01, 0, 0};
  EXPECT_EQ(poly(curve_tests::golden_curve(), elsewhere),
            "the curve does not start at the tool's position");
}

struct PolyTextCase {
  const char* name;
  const char* text;
  std::vector<std::string> alarms;
  const char* why;  // of the reader, from line 1; empty where it reads
};

class PolyTexts : public testing::TestWithParam<PolyTextCase> {};

TEST_P(PolyTexts, GiveTheirAlarms) {
  EXPECT_EQ(curve_tests::short_forms(poly_alarms(parsed(GetParam().text))), GetParam().alarms);
}

TEST_P(PolyTexts, AreReadOrRefused) {
  EXPECT_EQ(refusal_of(read_poly(GetParam().text)), GetParam().why);
}

INSTANTIATE_TEST_SUITE_P(
    Poly, PolyTexts,
    testing::Values(
        PolyTextCase{"NotActive", "G1 X1\nPO[X]=(2,1)\n", {"2 poly-not-active"}, "no POLY"},
        PolyTextCase{
            "EndedByALine", "POLY PO[X]=(2,1)\nG1 X3\nPO[X]=(4,1)\n", {"3 poly-not-active"}, ""},
        PolyTextCase{"EndedByASpline",
                     "POLY PO[X]=(2,1)\nBSPLINE\nPO[X]=(4,1)\n",
                     {"3 poly-not-active"},
                     ""},
        PolyTextCase{"IntervalTooShort",
                     "POLY PO[X]=(2,1) PL=0.00001\n",
                     {"1 poly-length"},
                     "PL out of range"},
        PolyTextCase{"DenominatorZero",
                     "POLY PO[X]=(2,1) PO[]=(1,8)\n",
                     {"1 poly-denominator"},
                     "a polynomial that is rational or above the third degree"},
        PolyTextCase{"FifthDegree",
                     "POLY PO[X]=(2,1,1,0,1)\n",
                     {"1 poly-degree"},
                     "a polynomial that is rational or above the third degree"},
        PolyTextCase{
            "Compensation", "G41 D1\nPOLY PO[X]=(2,1)\n", {"2 poly-compensation"}, "no POLY"},
        PolyTextCase{"Expression", "POLY PO[X]=(R1,1)\n", {}, "no POLY"},
        PolyTextCase{"OtherWords", "POLY PO[X]=(2,1) M8\n", {}, "no POLY"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Poly, LongLinesAreAnAlarm) {
  const std::string text = "POLY PO[X]=(1,2) ;" + std::string(500, '-') + "\n";
  EXPECT_EQ(curve_tests::short_forms(poly_alarms(parsed(text))),
            std::vector<std::string>{"1 line-too-long"});
}

// --- BSPLINE ------------------------------------------------------------------------------------

TEST(Bspline, IsNoDefaultAndToldOf) {
  EXPECT_FALSE(siemens_bspline().is_default);
  EXPECT_TRUE(siemens_bspline().caution.starts_with("BSPLINE is not verified"));
}

TEST(Bspline, RefusesIntervalsThatAreNoClampedCubic) {
  for (const char* text :
       {"BSPLINE SD=3 X1 PL=1\nX2 PL=0\n", "BSPLINE X1 PL=1\nX2 PL=0\nX3 PL=1\n",
        "BSPLINE X1 PL=0\nX2 PL=0\nX3 PL=0\n", "BSPLINE X1 PL=0\nX2 PL=1\nX3 PL=0\nX4 PL=0\n"}) {
    EXPECT_EQ(refusal_of(siemens_bspline().read(parsed(text), 0, starting_at(Point3::Zero()))),
              "PL of the blocks is no clamped cubic")
        << text;
  }
  for (const char* text : {"G1 X1\n", "BSPLINE SD=2 X1 PL=1\n", "BSPLINE X1\n"}) {
    EXPECT_EQ(refusal_of(siemens_bspline().read(parsed(text), 0, starting_at(Point3::Zero()))),
              "no BSPLINE")
        << text;
  }
}

// --- words ---------------------------------------------------------------------------------------

TEST(SiemensWords, AreReadWithAndWithoutBlanks) {
  const auto words = read_siemens_words("N10 POLY PO[X] = (0.25, 0.5 ,-1)PL=2 X=3Y-.5 ; PO[Z]=(1)");
  ASSERT_TRUE(words);
  std::vector<std::string> names;
  for (const SiemensWord& word : *words) names.push_back(word.name);
  EXPECT_EQ(names, (std::vector<std::string>{"N", "POLY", "PO[X]", "PL", "X", "Y"}));
  EXPECT_EQ((*words)[2].values, (std::vector<double>{0.25, 0.5, -1}));
  EXPECT_EQ((*words)[5].value(), -0.5);
  EXPECT_EQ((*words)[2].decimals, 2);
}

TEST(SiemensWords, WhatIsNoPlainNumberIsNotUnderstood) {
  for (const char* block : {"X=R1", "X=AC(10)", "X1=10", "MSG(\"a\")", "X1EX3", "PO[X]=(1,2",
                            "PO[X=(1)", "X", "LABEL:", "X--1", "PO[X]=()", "X=1000000000"}) {
    EXPECT_FALSE(read_siemens_words(block)) << block;
  }
}

}  // namespace
}  // namespace batten::gcode
