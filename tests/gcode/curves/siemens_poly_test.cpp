#include "gcode/curves/siemens_poly.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "gcode/curves/bezier_chain.h"
#include "gcode/curves/siemens_words.h"
#include "geometry/distance/path_distance.h"
#include "tests/support/curve_texts.h"
#include "tests/support/poly_alarms.h"

namespace batten::gcode {
namespace {

using curve_tests::parsed;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineCurve;
using geometry::CubicBezier;
using geometry::Point3;

constexpr std::uint32_t kProvedSeeds = 5;

CurveSetting siemens_setting() {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 6};
  setting.feeds = {.decimals = 3};
  return setting;
}

CurveSetting golden_setting() {
  CurveSetting setting = siemens_setting();
  setting.axes = {true, true, false};
  return setting;
}

std::string refusal_of(const CurveResult& result) {
  const auto* refusal = std::get_if<CurveRefusal>(&result);
  return refusal != nullptr ? refusal->why : "";
}

PolyText poly_of(const std::string& text, std::uint32_t first, const Point3& start) {
  auto read = read_poly_text(parsed(text), first, starting_at(start));
  if (const auto* refusal = std::get_if<CurveRefusal>(&read)) {
    ADD_FAILURE() << refusal->why << "\n" << text;
    return {};
  }
  return std::get<PolyText>(std::move(read));
}

// --- the golden curve
// -----------------------------------------------------------------------------

constexpr const char* kGolden =
    "POLY PO[X]=(18,-18,6) PO[Y]=(6.4,12,-5.6)\n"
    "PO[X]=(40,0,4) PO[Y]=(0,-10.8,-6.4)\n";

constexpr const char* kGoldenProgram =
    "N10 G1 X0 Y0 F3000\n"
    "N20 POLY PO[X]=(18,-18,6) PO[Y]=(6.4,12,-5.6)\n"
    "N30 PO[X]=(40,0,4) PO[Y]=(0,-10.8,-6.4)\n"
    "N40 G1 X50\n";

TEST(Poly, WritesTheGoldenCurve) {
  EXPECT_EQ(text_of(write_poly(curve_tests::golden_curve().bezier_pieces(), golden_setting())),
            kGolden);
}

TEST(Poly, ReadsTheGoldenProgramAtItsFiveValues) {
  const PolyText text = poly_of(kGoldenProgram, 1, Point3::Zero());
  ASSERT_EQ(text.pieces.size(), 2U);
  EXPECT_EQ(text.blocks, 2U);
  for (const auto& [u, x, y] : curve_tests::kGoldenValues) {
    const Point3 at =
        u <= 0.4 ? text.pieces[0].point_at(u / 0.4) : text.pieces[1].point_at((u - 0.4) / 0.6);
    EXPECT_LT((at - Point3(x, y, 0)).norm(), 1e-12) << u;
  }
  EXPECT_EQ(curve_tests::short_forms(poly_alarms(parsed(kGoldenProgram))),
            std::vector<std::string>{});
}

TEST(Poly, SaysTheFeedInTheFirstBlock) {
  CurveSetting setting = golden_setting();
  setting.feed = 1200;
  const std::string text =
      text_of(write_poly(curve_tests::golden_curve().bezier_pieces(), setting));
  EXPECT_EQ(text, "POLY PO[X]=(18,-18,6) PO[Y]=(6.4,12,-5.6) F1200\n" +
                      std::string(kGolden).substr(std::string(kGolden).find('\n') + 1));
  EXPECT_EQ(poly_of(text, 0, Point3::Zero()).feed, 1200);
}

TEST(Poly, LeavesOutZerosAtTheEnd) {
  const CubicBezier line{{{0, 0, 0}, {1, 2, 0}, {2, 4, 0}, {3, 6, 0}}};
  EXPECT_EQ(text_of(write_poly(std::vector{line}, golden_setting())), "POLY PO[X]=(3) PO[Y]=(6)\n");
}

// --- samples of the maker
// -------------------------------------------------------------------------

// Programming guide 840D advanced 04.00, p. 5-167: a quarter circle as a quotient.
TEST(Poly, ReadsTheQuarterCircleOfTheManual) {
  const std::string sample =
      "POLY G90 X10 Y0 F100\n"
      "PO[X]=(0,-10) PO[Y]=(10) PO[]=(2,1)\n";
  const PolyText text = poly_of(sample, 0, Point3(0, 0, 0));
  ASSERT_EQ(text.pieces.size(), 2U);
  EXPECT_EQ(text.feed, 100);
  EXPECT_TRUE(std::holds_alternative<geometry::Line>(text.pieces[0].piece().value()));
  const PolyBlock& quarter = text.pieces[1];
  EXPECT_FALSE(quarter.piece());
  for (const double p : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    // The result that the manual gives.
    const Point3 expected(10 * (1 - p * p) / (1 + p * p), 20 * p / (1 + p * p), 0);
    EXPECT_LT((quarter.point_at(p) - expected).norm(), 1e-12) << p;
  }
  EXPECT_EQ(curve_tests::short_forms(poly_alarms(parsed(sample))), std::vector<std::string>{});
  EXPECT_EQ(refusal_of(read_poly(parsed(sample), 0, starting_at(Point3::Zero()))),
            "a polynomial that is rational or above the third degree");
}

// The same guide, p. 5-165, its places given: PL, a straight axis beside a curved one.
TEST(Poly, ReadsTheSampleWithIntervals) {
  const std::string sample =
      "N11 POLY PO[X]=(1,2.5,0.7) PO[Y]=(0.3,1,3.2) PL=1.5\n"
      "N12 PO[X]=(0,2.5,1.7) PO[Y]=(2.3,1.7) PL=3\n"
      "N25 X70 PO[Y]=(9.3,1,7.67) PL=5\n"
      "N30 G1 X0 Y0 Z0\n";
  const PolyText text = poly_of(sample, 0, Point3::Zero());
  ASSERT_EQ(text.pieces.size(), 3U);
  EXPECT_EQ(text.blocks, 3U);
  EXPECT_EQ(curve_tests::short_forms(poly_alarms(parsed(sample))), std::vector<std::string>{});
  // p = 0.5 of N11: a1 = (1 - 2.5 * 2.25 - 0.7 * 3.375) / 1.5.
  const double a1 = (1 - 2.5 * 2.25 - 0.7 * 3.375) / 1.5;
  EXPECT_NEAR(text.pieces[0].point_at(0.5).x(), 0.5 * a1 + 2.5 * 0.25 + 0.7 * 0.125, 1e-12);
  EXPECT_LT((text.pieces[0].point_at(1.5) - Point3(1, 0.3, 0)).norm(), 1e-12);
  EXPECT_LT((text.pieces[1].point_at(0) - Point3(1, 0.3, 0)).norm(), 1e-12);
  // Straight in X: halfway at half the interval.
  EXPECT_NEAR(text.pieces[2].point_at(2.5).x(), 35, 1e-12);
  EXPECT_LT((text.pieces[2].point_at(5) - Point3(70, 9.3, 0)).norm(), 1e-9);
  // As Bezier pieces it is the same curve.
  for (const PolyBlock& block : text.pieces) {
    const auto piece = block.piece();
    ASSERT_TRUE(piece);
    for (const double t : {0.0, 0.25, 0.7, 1.0}) {
      const double off = (geometry::point_at(*piece, t) - block.point_at(t * block.length)).norm();
      EXPECT_LT(off, 1e-9) << t;
    }
  }
}

// --- random curves
// --------------------------------------------------------------------------------

TEST(Poly, RandomCurvesAreReadWithinTheirRounding) {
  // Ends move by half a step on every axis, and the curve with them; a coefficient that is off by e
  // moves the middle by e / 4 (p^2) and 0.385 e (p^3), which the control points exceed by a third.
  const double within = std::sqrt(3.0) * (0.5e-4 + 0.5e-6 * (1.0 / 3 + 2.0 / 3));
  double worst = 0;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const bool in_space = seed % 2 != 0;
    const BsplineCurve curve = curve_tests::random_curve(seed, in_space);
    CurveSetting setting = siemens_setting();
    setting.start = curve.control_points().front();
    setting.axes = {true, true, in_space};
    setting.feed = 900;
    const std::vector<CubicBezier> pieces = curve.bezier_pieces();
    const std::string text = text_of(write_poly(pieces, setting));
    EXPECT_TRUE(poly_alarms(parsed("G1 F100\n" + text + "G1\n")).empty()) << text;
    const auto result = read_poly(parsed(text + "G1 X0\n"), 0, starting_at(setting.start));
    ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << refusal_of(result);
    const auto& reading = std::get<CurveReading>(result);
    EXPECT_EQ(reading.blocks, pieces.size());
    EXPECT_EQ(reading.axes, setting.axes);
    const auto read = curve_tests::beziers_of(reading);
    const double move = greatest_move(pieces, read);
    EXPECT_LE(move, within);
    worst = std::max(worst, move);
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
    if (seed >= kProvedSeeds) continue;
    EXPECT_EQ(geometry::compare_paths(curve_tests::pieces_of(curve),
                                      curve_tests::pieces_of(reading), 1e-3)
                  .verdict,
              geometry::Verdict::kProved);
  }
  EXPECT_GT(worst, 0.1 * within) << "nothing was rounded";
}

TEST(Poly, TooFewDigitsAreADeviation) {
  int off = 0;
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const BsplineCurve curve = curve_tests::random_curve(seed, true);
    CurveSetting setting = siemens_setting();
    setting.start = curve.control_points().front();
    setting.other = {.decimals = 0};
    const std::string text = text_of(write_poly(curve.bezier_pieces(), setting));
    const auto result = read_poly(parsed(text), 0, starting_at(setting.start));
    ASSERT_TRUE(std::holds_alternative<CurveReading>(result));
    const auto pieces = curve_tests::pieces_of(std::get<CurveReading>(result));
    off += geometry::compare_paths(curve_tests::pieces_of(curve), pieces, 0.01).verdict ==
                   geometry::Verdict::kBroken
               ? 1
               : 0;
  }
  EXPECT_EQ(off, 20);
}

TEST(Poly, WritesInches) {
  CurveSetting setting = golden_setting();
  setting.units = Units::kInch;
  const CubicBezier piece{{{0, 0, 0}, {25.4, 0, 0}, {50.8, 25.4, 0}, {50.8, 50.8, 0}}};
  const std::string text = text_of(write_poly(std::vector{piece}, setting));
  // In inches (0,0) (1,0) (2,1) (2,2): a2 = 3 (b0 - 2 b1 + b2), a3 = b3 - 3 b2 + 3 b1 - b0.
  EXPECT_EQ(text, "POLY PO[X]=(2,0,-1) PO[Y]=(2,3,-1)\n");
  const auto result = read_poly(parsed(text), 0, starting_at(Point3::Zero(), Units::kInch));
  EXPECT_LT(
      greatest_move(std::vector{piece}, curve_tests::beziers_of(std::get<CurveReading>(result))),
      1e-9);
}

// --- refusals and alarms
// --------------------------------------------------------------------------

TEST(Poly, RefusesWhatItCannotSay) {
  const auto pieces = curve_tests::golden_curve().bezier_pieces();
  EXPECT_EQ(text_of(write_poly({}, golden_setting())), "no curve");
  CurveSetting elsewhere = golden_setting();
  elsewhere.start = {0.01, 0, 0};
  EXPECT_EQ(text_of(write_poly(pieces, elsewhere)),
            "the curve does not start where the tool stands");
}

struct PolyState {
  const char* name;
  void (*change)(ModalState&);
};

class PolyStates : public testing::TestWithParam<PolyState> {};

TEST_P(PolyStates, AreComplainedAbout) {
  ModalState state;
  EXPECT_EQ(poly_complaint(state), "");
  GetParam().change(state);
  EXPECT_NE(poly_complaint(state), "");
}

INSTANTIATE_TEST_SUITE_P(
    Poly, PolyStates,
    testing::Values(
        PolyState{"G41", [](ModalState& s) { s.cutter_compensation = TriState::kOn; }},
        PolyState{"G91", [](ModalState& s) { s.distance = DistanceMode::kIncremental; }},
        PolyState{"G95", [](ModalState& s) { s.feed_mode = FeedMode::kPerRevolution; }},
        PolyState{"TRAORI", [](ModalState& s) { s.tool_center_point = TriState::kUnknown; }},
        PolyState{"MIRROR", [](ModalState& s) { s.mirror = TriState::kOn; }}),
    [](const auto& test) { return std::string(test.param.name); });

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
  EXPECT_EQ(refusal_of(read_poly(parsed(GetParam().text), 0, starting_at(Point3::Zero()))),
            GetParam().why);
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
                     "a denominator that is 0"},
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

// --- words
// ----------------------------------------------------------------------------------------

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
