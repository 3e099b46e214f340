#include "gcode/curves/g5_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>
#include <vector>

#include "gcode/reading/parser.h"
#include "tests/support/curve_texts.h"
#include "tests/support/random_curves.h"

namespace batten::gcode {
namespace {

using geometry::CubicBezier;
using geometry::Point3;

CurveSetting setting_at(const Point3& start) {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 5};
  setting.feeds = {.decimals = 6};
  setting.start = start;
  return setting;
}

CurveResult read(const std::string& text, const Position& position,
                 Units units = Units::kMillimetre) {
  Diagnostics found;
  return linuxcnc_g5().read(parse(SourceText("test.nc", text), found), 0, {position, units});
}

const Position kOrigin{Point3(0, 0, -1), {true, true, true}};

// By hand: I J is the first leg of the polygon, P Q the last one backwards.
TEST(G5, SaysTheGoldenCurveInTwoBlocks) {
  CurveSetting setting = setting_at(Point3::Zero());
  setting.feed = 3000;
  const CurveWriting written = linuxcnc_g5().write(curve_tests::golden_curve(), setting);
  const auto* lines = std::get_if<CurveLines>(&written);
  ASSERT_NE(lines, nullptr);
  EXPECT_EQ(*lines,
            (CurveLines{"G5 X18 Y6.4 I10 J0 P-4 Q-2.4 F3000", "G5 X40 Y0 I6 J3.6 P-10 Q10"}));
}

TEST(G5, ReadsThePieceThatItSays) {
  const CurveResult result = read("G5 X18 Y6.4 I10 J0 P-4 Q-2.4 F3000\n", kOrigin);
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  EXPECT_EQ(reading->blocks, 1U);
  EXPECT_EQ(reading->feed, 3000);
  EXPECT_EQ(reading->axes, (std::array<bool, 3>{true, true, false}));
  const auto& piece = std::get<CubicBezier>(reading->motions.at(0).piece);
  EXPECT_EQ(piece.control[0], Point3(0, 0, -1));
  EXPECT_EQ(piece.control[1], Point3(10, 0, -1));
  EXPECT_EQ(piece.control[2], Point3(14, 4, -1));
  EXPECT_EQ(piece.control[3], Point3(18, 6.4, -1));
}

TEST(G5, ReadsInches) {
  const CurveResult result = read("G5 X1 Y0 I.25 J.5 P-.25 Q.5\n", kOrigin, Units::kInch);
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  const auto& piece = std::get<CubicBezier>(reading->motions.at(0).piece);
  EXPECT_LT((piece.control[2] - Point3(19.05, 12.7, -1)).norm(), 1e-12);
}

TEST(G5, RefusesToReadOtherBlocks) {
  for (const char* text :
       {"G1 X1 Y1", "G5 P10000", "G5 X1 Y1", "G5 X1 Y1 P1 Q1", "G5 X1 Y1 Z2 I1 J1 P1 Q1",
        "G5 X1 Y1 A2 I1 J1 P1 Q1", "G17 G5 X1 Y1 I1 J1 P1 Q1", "G5 X1 Y1 I1 J1 P1 Q1 M8",
        "G5 X[1] Y1 I1 J1 P1 Q1", "G5 X1 Y1 I1 J1 P1 Q1 F0"}) {
    EXPECT_TRUE(std::holds_alternative<CurveRefusal>(read(text, kOrigin))) << text;
  }
}

// Behind a G5 one without I and J leaves as the one before arrived. An axis without a word stays.
TEST(G5, GoesOnFromTheOneBefore) {
  const CurveResult result =
      read("G5 X10 I0 J3 P1 Q-2 F700\n(a)\nG5 X20.25 Y1 P0 Q3\nG1 X30\n", kOrigin);
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  EXPECT_EQ(reading->blocks, 3U);
  EXPECT_EQ(reading->decimals, 2);
  EXPECT_EQ(reading->feed, 700);
  ASSERT_EQ(reading->motions.size(), 2U);
  EXPECT_EQ(reading->motions[1].block, 2U);
  const auto& first = std::get<CubicBezier>(reading->motions[0].piece);
  const auto& second = std::get<CubicBezier>(reading->motions[1].piece);
  EXPECT_EQ(first.control[2], Point3(11, -2, -1));
  EXPECT_EQ(first.control[3], Point3(10, 0, -1));
  EXPECT_EQ(second.control[1], Point3(9, 2, -1));
  EXPECT_EQ(second.control[2], Point3(20.25, 4, -1));
  EXPECT_EQ(second.control[3], Point3(20.25, 1, -1));
}

// A whole one is a curve of its own, and so ends one that goes on; a feed of its own ends it too.
TEST(G5, EndsWhereTheNextOneDoesNotGoOn) {
  for (const char* next :
       {"G5 X20 Y0 I1 J1 P0 Q3", "G5 X20 Y0 P0 Q3 F9", "X20 P0 Q3", "G5 P0 Q3"}) {
    const CurveResult result = read(std::string("G5 X10 I0 J3 P1 Q-2\n") + next + "\n", kOrigin);
    ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << next;
    EXPECT_EQ(std::get<CurveReading>(result).blocks, 1U) << next;
  }
}

// One inner control point, (5, 3) from the start: the cubic that is the same has 2/3 of each leg.
TEST(G51, IsAQuadraticPiece) {
  const CurveResult result = read("G5.1 X40 I5 J3\n", kOrigin);
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  const auto& piece = std::get<CubicBezier>(reading->motions.at(0).piece);
  EXPECT_LT((piece.control[1] - Point3(10.0 / 3, 2, -1)).norm(), 1e-12);
  EXPECT_LT((piece.control[2] - Point3(50.0 / 3, 2, -1)).norm(), 1e-12);
  EXPECT_EQ(reading->motions.at(0).arcs, 24) << "8 for each of its points, as LinuxCNC makes them";
  // At a quarter: 9/16 P0 + 6/16 P1 + 1/16 P2.
  EXPECT_LT((geometry::point_at(piece, 0.25) - Point3(4.375, 1.125, -1)).norm(), 1e-12);
}

// Where LinuxCNC 2.9 goes in this program, measured: at 0.15 and 0.3 of the first of three spans,
// the middle of the second, and the end.
TEST(G52, GoesWhereLinuxCncGoes) {
  const CurveResult result =
      read("G5.2 X3 Y3 P1 L3\nX5 Y2 P1\n(a)\nX6 Y0 P1\nX8 Y1 P1\nG5.3\nG1 X9\n",
           {Point3(1, 2, 0), {true, true, true}});
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  EXPECT_EQ(reading->blocks, 6U);
  ASSERT_EQ(reading->motions.size(), 3U);
  EXPECT_EQ(reading->motions[0].block, 1U);
  EXPECT_EQ(reading->motions[2].block, 4U);
  const auto at = [&](std::size_t piece, double t) {
    return geometry::point_at(reading->motions[piece].piece, t);
  };
  EXPECT_LT((at(0, 0.15) - Point3(1.5775, 2.26625, 0)).norm(), 1e-5);
  EXPECT_LT((at(0, 0.3) - Point3(2.11, 2.465, 0)).norm(), 1e-5);
  EXPECT_LT((at(1, 0.5) - Point3(4.875, 1.875, 0)).norm(), 1e-5);
  EXPECT_LT((at(2, 1) - Point3(8, 1, 0)).norm(), 1e-12);
}

TEST(G52, OfOrderFourIsCubic) {
  const CurveResult result = read("G5.2 P1 L4 F50\nX1 Y1 P1\nX2 Y1 P1\nX3 Y0 P1\nG5.3\n", kOrigin);
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  EXPECT_EQ(reading->feed, 50);
  ASSERT_EQ(reading->motions.size(), 1U);
  const auto& piece = std::get<CubicBezier>(reading->motions[0].piece);
  EXPECT_LT((piece.control[1] - Point3(1, 1, -1)).norm(), 1e-12);
  EXPECT_LT((piece.control[2] - Point3(2, 1, -1)).norm(), 1e-12);
}

// The points of the first order of four, on its first span, with weights: (sum of w b P) / (sum of
// w b) for Bernstein's b.
TEST(G52, ReadsWeights) {
  const CurveResult result = read("G5.2 P1 L4 F50\nX1 Y1 P2\nX2 Y1 P.5\nX3 Y0 P3\nG5.3\n", kOrigin);
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  EXPECT_TRUE(reading->is_near);
  const auto on_curve = [](double u) {
    const double b[] = {std::pow(1 - u, 3), 2 * 3 * u * std::pow(1 - u, 2),
                        0.5 * 3 * u * u * (1 - u), 3 * std::pow(u, 3)};
    const double weight = b[0] + b[1] + b[2] + b[3];
    return Point3((b[1] + 2 * b[2] + 3 * b[3]) / weight, (b[1] + b[2]) / weight, -1);
  };
  for (const CurveMotion& motion : reading->motions) {
    for (int k = 0; k <= 4; ++k) {
      // X grows with u.
      const Point3 on = geometry::point_at(motion.piece, k / 4.0);
      double low = 0;
      double high = 1;
      while (high - low > 1e-14) {
        const double u = 0.5 * (low + high);
        (on_curve(u).x() < on.x() ? low : high) = u;
      }
      EXPECT_LT((on - on_curve(low)).norm(), 2 * kReadWithin);
    }
  }
}

// Orders of five and six, whose pieces are not cubic: the fourth degree between five points.
TEST(G52, ReadsOrdersAboveFour) {
  const CurveResult result =
      read("G5.2 L5\nX1 Y1 P1\nX2 Y1 P1\nX3 Y1 P1\nX4 Y0 P1\nG5.3\n", kOrigin);
  const auto* reading = std::get_if<CurveReading>(&result);
  ASSERT_NE(reading, nullptr);
  const auto middle = reading->motions.size() / 2;
  ASSERT_GT(reading->motions.size(), 1U);
  // At a half: (P0 + 4 P1 + 6 P2 + 4 P3 + P4) / 16.
  EXPECT_LT(
      (geometry::start_point(reading->motions[middle].piece) - Point3(2, 14.0 / 16, -1)).norm(),
      kReadWithin);
}

TEST(G52, RefusesWhatIsNoBsplineOrIsRefusedByTheControl) {
  for (const char* text :
       {"G5.2 P2 L3\nX1 Y1 P2\nX2 Y1 P2\nX3 Y0 P2\nG5.3", "G5.2 L3\nX1 Y1 P1\nX2 Y1 P0\nG5.3",
        "G5.2 L3\nX1 Y1\nX2 Y1 P1\nG5.3", "G5.2 L3\nX1 P1\nX2 Y1 P1\nG5.3",
        "G5.2 L4\nX1 Y1 P1\nX2 Y1 P1\nG5.3",
        "G5.2 L7\nX1 Y1 P1\nX2 Y1 P1\nX3 Y1 P1\nX4 Y1 P1\nX5 Y2 P1\nX6 Y1 P1\nG5.3",
        "G5.2 L3\nX1 Y1 P1\nG1 X2 Y1\nG5.3", "G5.2 L3\nX1 Y1 P1\nX2 Y1 P1 F9\nG5.3",
        "G5.2 L3\nX1 Y1 P1\nX2 Y1 P1\nG5.3 X3 Y3", "G5.2 L3\nX1 Y1 P1\nX2 Y1 P1\n",
        "G5.2 X1 L3\nX2 Y1 P1\nG5.3", "G5.2 L3\nX1 Y1 P1\nX2 Y1 Z3 P1\nG5.3",
        "G5.2 L3 M8\nX1 Y1 P1\nX2 Y1 P1\nG5.3"}) {
    EXPECT_TRUE(std::holds_alternative<CurveRefusal>(read(text, kOrigin))) << text;
  }
}

TEST(G5, OfGrblHalAndMarlinHasAllItsWords) {
  Diagnostics found;
  for (const char* text :
       {"G5 X10 I0 J3 P1 Q-2", "G5.1 X40 I5 J3", "G5.2 L3\nX1 Y1 P1\nX2 Y1 P1\nG5.3"}) {
    const Program program = parse(SourceText("test.nc", text), found);
    EXPECT_TRUE(std::holds_alternative<CurveRefusal>(
        chopped_g5().read(program, 0, {kOrigin, Units::kMillimetre})))
        << text;
    EXPECT_TRUE(std::holds_alternative<CurveReading>(read(text, kOrigin))) << text;
  }
}

TEST(G5, NeedsAKnownPlace) {
  Position nowhere = kOrigin;
  nowhere.known[1] = false;
  EXPECT_TRUE(std::holds_alternative<CurveRefusal>(read("G5 X1 Y1 I1 J1 P1 Q1", nowhere)));
}

TEST(G5, RefusesAPieceInSpaceAndOneWithoutDirection) {
  CubicBezier piece{{Point3(0, 0, 0), Point3(1, 0, 0), Point3(2, 1, 0), Point3(3, 3, 0.001)}};
  const auto is_written = [&piece] {
    return std::holds_alternative<CurveLines>(
        linuxcnc_g5().write(curve_tests::curve_of({piece}), setting_at(Point3::Zero())));
  };
  EXPECT_FALSE(is_written());
  piece.control[3] = Point3(3, 3, 0);
  EXPECT_TRUE(is_written());
  piece.control[1] = Point3(1e-6, 0, 0);
  EXPECT_FALSE(is_written());
}

TEST(G5, OnLinuxCncTakesOnlyPiecesThatBendOneWay) {
  const auto takes = [](double x1, double y1, double x2, double y2, double x3, double y3) {
    return linuxcnc_g5().takes(
        {{Point3(0, 0, 0), Point3(x1, y1, 0), Point3(x2, y2, 0), Point3(x3, y3, 0)}});
  };
  EXPECT_TRUE(takes(1, 0, 2, 0.5, 2.5, 1.5));
  EXPECT_TRUE(takes(1, 0, 2, -0.5, 2.5, -1.5));
  EXPECT_FALSE(takes(1, 0, 2, 0, 3, 0)) << "a straight line";
  EXPECT_FALSE(takes(1, 1, 2, 2, 3, 3)) << "a straight line across";
  EXPECT_FALSE(takes(1, 0, 2, 1, 3, 1)) << "an S with parallel tangents at its ends";
  EXPECT_FALSE(takes(1, 0, 2, 1, 3.5, 1.2)) << "an S";
  EXPECT_FALSE(takes(1, 0, 2, 0, 3, 1e-3)) << "all but straight at its start";
  EXPECT_FALSE(takes(4, 0, 4, 5, -1, -1)) << "more than half a turn";
}

// --- chords -------------------------------------------------------------------------------------

// A quarter circle from (r, 0) to (0, r), right to 0.0003 r.
CubicBezier quarter(double r) {
  const double k = 4.0 / 3 * std::tan(M_PI / 8) * r;
  return {{Point3(r, 0, 0), Point3(r, k, 0), Point3(k, r, 0), Point3(0, r, 0)}};
}

Point3 bezier_at(const CubicBezier& piece, double t) {
  const double s = 1 - t;
  return s * s * s * piece.control[0] + 3 * s * s * t * piece.control[1] +
         3 * s * t * t * piece.control[2] + t * t * t * piece.control[3];
}

// By brute force, from the ends alone.
double sampled_error(const CubicBezier& piece) {
  double most = 0;
  double from = 0;
  for (const double end : chopped_at(piece)) {
    const Point3 a = bezier_at(piece, from);
    const geometry::Vector3 way = bezier_at(piece, end) - a;
    for (int i = 1; i < 50; ++i) {
      const geometry::Vector3 to = bezier_at(piece, from + (end - from) * i / 50) - a;
      const double along = std::clamp(to.dot(way) / way.squaredNorm(), 0.0, 1.0);
      most = std::max(most, (to - along * way).norm());
    }
    from = end;
  }
  return most;
}

// What the algorithm of those sources gives for known curves: 0.046 to 0.052 mm for the two pieces
// of the golden curve, up to 0.066 mm for quarter circles of some radii. Their test is the sum of
// both axes at the middle of a chord, which is the distance at least.
TEST(G5Chopping, LeavesCurvesAsFarAsItIsKnownTo) {
  for (const CubicBezier& piece : curve_tests::golden_curve().bezier_pieces()) {
    EXPECT_GE(sampled_error(piece), 0.0455);
    EXPECT_LE(sampled_error(piece), 0.0525);
  }
  double most = 0;
  for (int r = 5; r <= 200; ++r) most = std::max(most, sampled_error(quarter(r)));
  EXPECT_GE(most, 0.066);
  EXPECT_LE(most, 0.1);
}

TEST(G5Chopping, BoundsWhatIsSampled) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    for (const CubicBezier& piece : tests::random_curve(seed, true).bezier_pieces()) {
      const double sampled = sampled_error(piece);
      EXPECT_LE(sampled, chopped_g5().chords_error(piece) + 1e-12) << seed;
    }
  }
}

// The step starts with a tenth and never grows there.
TEST(G5Chopping, MakesTenChordsOfWhatIsShort) {
  const std::vector<double> ends = chopped_at(quarter(1));
  EXPECT_GE(ends.size(), 5U);
  EXPECT_LE(ends.size(), 11U);
  EXPECT_EQ(ends.back(), 1);
  EXPECT_TRUE(std::is_sorted(ends.begin(), ends.end()));
}

}  // namespace
}  // namespace batten::gcode
