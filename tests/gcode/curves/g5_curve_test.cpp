#include "gcode/curves/g5_curve.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "gcode/reading/parser.h"
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
  return read_g5(parse(SourceText("test.nc", text), found), 0, {position, units});
}

const Position kOrigin{Point3(0, 0, -1), {true, true, true}};

// By hand: I J is the first leg of the polygon, P Q the last one backwards.
TEST(G5, SaysTheGoldenCurveInTwoBlocks) {
  CurveSetting setting = setting_at(Point3::Zero());
  setting.feed = 3000;
  const CurveWriting written = write_g5(tests::golden_curve().bezier_pieces(), setting);
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

struct Refused {
  std::string name;
  std::string text;
};
class G5Refuses : public testing::TestWithParam<Refused> {};

TEST_P(G5Refuses, ToRead) {
  EXPECT_TRUE(std::holds_alternative<CurveRefusal>(read(GetParam().text, kOrigin)));
}

INSTANTIATE_TEST_SUITE_P(Blocks, G5Refuses,
                         testing::Values(Refused{"ALine", "G1 X1 Y1"},
                                         Refused{"HighSpeedMode", "G5 P10000"},
                                         Refused{"WithoutOffsets", "G5 X1 Y1"},
                                         Refused{"ContinuedTangent", "G5 X1 Y1 P1 Q1"},
                                         Refused{"AZWord", "G5 X1 Y1 Z2 I1 J1 P1 Q1"},
                                         Refused{"ATurningAxis", "G5 X1 Y1 A2 I1 J1 P1 Q1"},
                                         Refused{"AnotherCode", "G17 G5 X1 Y1 I1 J1 P1 Q1"},
                                         Refused{"AnMWord", "G5 X1 Y1 I1 J1 P1 Q1 M8"},
                                         Refused{"AnExpression", "G5 X[1] Y1 I1 J1 P1 Q1"},
                                         Refused{"NoFeed", "G5 X1 Y1 I1 J1 P1 Q1 F0"}),
                         [](const auto& test) { return test.param.name; });

TEST(G5, NeedsAKnownPlace) {
  Position nowhere = kOrigin;
  nowhere.known[1] = false;
  EXPECT_TRUE(std::holds_alternative<CurveRefusal>(read("G5 X1 Y1 I1 J1 P1 Q1", nowhere)));
}

TEST(G5, RefusesAPieceInSpaceAndOneWithoutDirection) {
  CubicBezier piece{{Point3(0, 0, 0), Point3(1, 0, 0), Point3(2, 1, 0), Point3(3, 3, 0.001)}};
  EXPECT_TRUE(std::holds_alternative<CurveRefusal>(write_g5({piece}, setting_at(Point3::Zero()))));
  piece.control[3] = Point3(3, 3, 0);
  EXPECT_TRUE(std::holds_alternative<CurveLines>(write_g5({piece}, setting_at(Point3::Zero()))));
  piece.control[1] = Point3(1e-6, 0, 0);
  EXPECT_TRUE(std::holds_alternative<CurveRefusal>(write_g5({piece}, setting_at(Point3::Zero()))));
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

}  // namespace
}  // namespace batten::gcode
