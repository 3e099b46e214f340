#include "gcode/curves/klartext_moves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/support/curve_texts.h"

namespace batten::gcode {
namespace {

using curve_tests::parsed;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::Arc;
using geometry::Line;
using geometry::PathPiece;
using geometry::Point3;
using geometry::Vector3;

constexpr double kPi = std::numbers::pi;

CurveSetting setting_at(const Point3& start) {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 4};
  setting.feeds = {.decimals = 3};
  setting.start = start;
  return setting;
}

std::string refusal_of(const CurveResult& result) {
  const auto* refusal = std::get_if<CurveRefusal>(&result);
  return refusal != nullptr ? refusal->why : "";
}

Arc arc_about(const Point3& start, const Point3& center, double sweep) {
  const Vector3 out = start - center;
  const Vector3 turned(std::cos(sweep) * out.x() - std::sin(sweep) * out.y(),
                       std::sin(sweep) * out.x() + std::cos(sweep) * out.y(), 0);
  return {start, center + turned, center, Vector3::UnitZ(), sweep};
}

// A slot: line, half circle to the left, line, a quarter to the right, down.
TEST(KlartextMoves, AreWrittenByteForByte) {
  const std::vector<PathPiece> pieces = {
      Line{{0, 0, -1}, {20, 0, -1}}, arc_about({20, 0, -1}, {20, 5, -1}, kPi),
      Line{{20, 10, -1}, {5.5, 10, -1}}, arc_about({5.5, 10, -1}, {5.5, 12.25, -1}, -kPi / 2),
      Line{{3.25, 12.25, -1}, {3.25, 12.25, -2}}};
  CurveSetting setting = setting_at({0, 0, -1});
  setting.feed = 800;
  EXPECT_EQ(text_of(write_klartext_moves(pieces, setting, 4)),
            "4 L X+20 F800\n"
            "5 CC X+20 Y+5\n"
            "6 C X+20 Y+10 DR+\n"
            "7 L X+5.5\n"
            "8 CC X+5.5 Y+12.25\n"
            "9 C X+3.25 Y+12.25 DR-\n"
            "10 L Z-2\n");
}

TEST(KlartextMoves, ReadWhatAFreeCadPostWrites) {
  const std::string text =
      "6 L X34.129 Y36.811 Z4.000 R0 F3 M\n"
      "7 CC X28.908 Y31.590\n"
      "8 C X36.113 Y33.202 DR- R0 M\n"
      "9 END PGM MM\n";
  const auto result = read_klartext_moves(parsed(text), 0, starting_at(Point3::Zero()));
  ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << refusal_of(result);
  const auto& reading = std::get<CurveReading>(result);
  EXPECT_EQ(reading.blocks, 3U);
  ASSERT_EQ(reading.motions.size(), 2U);
  EXPECT_EQ(reading.motions[1].block, 2U);
  const Arc& arc = std::get<Arc>(reading.motions[1].piece);
  EXPECT_LT(arc.sweep, 0);
  EXPECT_EQ(arc.end, Point3(36.113, 33.202, 4));
}

TEST(KlartextMoves, TenThousandRandomArcsCloseAndAreReadAsWritten) {
  std::mt19937 random(7);
  const auto between = [&random](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
  };
  double worst = 0;
  for (int i = 0; i < 10000; ++i) {
    const double radius = std::exp(between(std::log(0.1), std::log(1000)));
    const double angle = between(0, 2 * kPi);
    Point3 start(std::round(between(-1e6, 1e6)) / 1e4, std::round(between(-1e6, 1e6)) / 1e4, 2);
    const Point3 center = start - radius * Vector3(std::cos(angle), std::sin(angle), 0);
    // At least a hundredth of a millimetre long, up to nearly a full turn.
    const double least = std::max(0.01, 0.01 / radius);
    const double sweep = (i % 2 == 0 ? 1 : -1) * between(least, 6.1);
    const Arc arc = arc_about(start, center, sweep);
    const std::string text =
        text_of(write_klartext_moves(std::vector<PathPiece>{arc}, setting_at(start), {}));
    const std::string line = "L X" + to_text(start.x(), {.decimals = 4}) + " Y" +
                             to_text(start.y(), {.decimals = 4}) + "\n";
    EXPECT_EQ(
        curve_tests::short_forms(klartext_arc_alarms(parsed(line + text), Units::kMillimetre)),
        std::vector<std::string>{})
        << text;
    const auto result = read_klartext_moves(parsed(text), 0, starting_at(start));
    ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << refusal_of(result) << text;
    const Arc& read = std::get<Arc>(std::get<CurveReading>(result).motions.at(0).piece);
    EXPECT_NEAR(read.sweep, sweep, 0.02);
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
      const double off = (geometry::point_at(read, t) - geometry::point_at(arc, t)).norm();
      worst = std::max(worst, off);
    }
  }
  EXPECT_LT(worst, 0.01);
  EXPECT_GT(worst, 1e-5) << "nothing was rounded";
}

TEST(KlartextMoves, RefuseWhatTheyCannotSay) {
  const auto refused = [](const PathPiece& piece, const CurveSetting& setting) {
    return text_of(write_klartext_moves(std::vector{piece}, setting, {}));
  };
  const CurveSetting setting = setting_at(Point3::Zero());
  const Arc quarter = arc_about(Point3::Zero(), {5, 0, 0}, kPi / 2);
  EXPECT_EQ(text_of(write_klartext_moves({}, setting, {})), "no moves");
  Arc helix = quarter;
  helix.end.z() = 1;
  EXPECT_EQ(refused(helix, setting), "a helix");
  Arc upright = quarter;
  upright.axis = Vector3::UnitY();
  EXPECT_EQ(refused(upright, setting), "an arc out of the plane of X and Y");
  const Point3 origin = Point3::Zero();
  const geometry::CubicBezier standing{{origin, origin, origin, origin}};
  EXPECT_EQ(refused(standing, setting), "a piece that is neither line nor arc");
  const Arc tiny = arc_about(Point3::Zero(), {5, 0, 0}, 1e-6);
  EXPECT_EQ(refused(tiny, setting), "an arc that is a full turn or none");
  CurveSetting flat = setting;
  flat.axes = {true, true, false};
  EXPECT_EQ(refused(Line{Point3::Zero(), {0, 0, 1}}, flat), "an axis moves and has no word");
}

struct KlartextCase {
  const char* name;
  const char* text;
  const char* why;
};

class KlartextRefusals : public testing::TestWithParam<KlartextCase> {};

TEST_P(KlartextRefusals, AreSaid) {
  EXPECT_EQ(
      refusal_of(read_klartext_moves(parsed(GetParam().text), 0, starting_at(Point3::Zero()))),
      GetParam().why);
}

INSTANTIATE_TEST_SUITE_P(
    KlartextMoves, KlartextRefusals,
    testing::Values(KlartextCase{"NoCentre", "1 C X+1 Y+1 DR+\n", "a C without a CC before it"},
                    KlartextCase{"NoSense", "1 CC X+1 Y+0\n2 C X+1 Y+1\n", "a C without DR"},
                    KlartextCase{"Helix", "1 CC X+1 Y+0\n2 C X+1 Y+1 Z+1 DR+\n", "a C with Z"},
                    KlartextCase{"OffItsCircle", "1 CC X+5 Y+0\n2 C X+10.017 Y+0 DR+\n",
                                 "the radii at the ends of an arc differ"},
                    KlartextCase{"HalfACentre", "1 CC X+1\n", "a CC without X and Y"},
                    KlartextCase{"Rapid", "1 L X+1 FMAX\n", "no L, CC or C"},
                    KlartextCase{"Compensation", "1 L X+1 RL F100\n", "no L, CC or C"},
                    KlartextCase{"Incremental", "1 L IX+1\n", "no L, CC or C"},
                    KlartextCase{"Function", "1 L X+1 M8\n", "no L, CC or C"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(KlartextMoves, ArcsThatAreNoneGiveAlarms) {
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
  EXPECT_EQ(curve_tests::short_forms(klartext_arc_alarms(parsed(text), Units::kMillimetre)),
            (std::vector<std::string>{"2 arc-no-centre", "4 arc-no-sense", "4 arc-radius",
                                      "8 arc-radius", "9 place-range"}));
}

}  // namespace
}  // namespace batten::gcode
