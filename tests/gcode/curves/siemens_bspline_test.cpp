#include "gcode/curves/siemens_bspline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "gcode/curves/bezier_chain.h"
#include "tests/support/curve_texts.h"

namespace batten::gcode {
namespace {

using curve_tests::parsed;
using curve_tests::starting_at;
using curve_tests::text_of;
using geometry::BsplineCurve;
using geometry::Point3;

constexpr BsplineUse kAccepted = BsplineUse::kAcceptedUnverified;

CurveSetting siemens_setting() {
  CurveSetting setting;
  setting.places = {.decimals = 4};
  setting.other = {.decimals = 4};
  setting.feeds = {.decimals = 3};
  return setting;
}

constexpr const char* kGolden =
    "BSPLINE SD=3 X10 Y0 PL=40 F3000\n"
    "X20 Y10 PL=60\n"
    "X30 Y10 PL=0\n"
    "X40 Y0 PL=0\n";

std::string refusal_of(const CurveResult& result) {
  const auto* refusal = std::get_if<CurveRefusal>(&result);
  return refusal != nullptr ? refusal->why : "";
}

TEST(Bspline, IsWrittenAndReadOnlyWhereTheUserAcceptsWhatIsUnverified) {
  const CurveWriting writing =
      write_bspline(curve_tests::golden_curve(), siemens_setting(), BsplineUse::kNotAccepted);
  EXPECT_EQ(text_of(writing), kBsplineUnverified);
  EXPECT_EQ(refusal_of(read_bspline(parsed(kGolden), 0, starting_at(Point3::Zero()),
                                    BsplineUse::kNotAccepted)),
            kBsplineUnverified);
}

TEST(Bspline, WritesTheGoldenCurve) {
  CurveSetting setting = siemens_setting();
  setting.axes = {true, true, false};
  setting.feed = 3000;
  EXPECT_EQ(text_of(write_bspline(curve_tests::golden_curve(), setting, kAccepted)), kGolden);
}

TEST(Bspline, ReadsTheGoldenCurveAtItsFiveValues) {
  const auto result = read_bspline(parsed(std::string(kGolden) + "G1 X50\n"), 0,
                                   starting_at(Point3::Zero()), kAccepted);
  ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << refusal_of(result);
  const auto& reading = std::get<CurveReading>(result);
  EXPECT_EQ(reading.blocks, 4U);
  EXPECT_EQ(reading.feed, 3000);
  ASSERT_EQ(reading.motions.size(), 2U);
  for (const auto& [u, x, y] : curve_tests::kGoldenValues) {
    const Point3 at = u <= 0.4 ? geometry::point_at(reading.motions[0].piece, u / 0.4)
                               : geometry::point_at(reading.motions[1].piece, (u - 0.4) / 0.6);
    EXPECT_LT((at - Point3(x, y, 0)).norm(), 1e-12) << u;
  }
}

TEST(Bspline, RandomCurvesAreReadWithinTheirRounding) {
  // Half a step on every axis for the points, one step for the knots.
  const double within = (std::sqrt(3.0) / 2 + 1) * 1e-4;
  for (std::uint32_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = curve_tests::random_curve(seed, seed % 2 != 0);
    CurveSetting setting = siemens_setting();
    setting.start = curve.control_points().front();
    const std::string text = text_of(write_bspline(curve, setting, kAccepted));
    const auto result = read_bspline(parsed(text), 0, starting_at(setting.start), kAccepted);
    ASSERT_TRUE(std::holds_alternative<CurveReading>(result)) << refusal_of(result);
    EXPECT_LE(greatest_move(curve.bezier_pieces(),
                            curve_tests::beziers_of(std::get<CurveReading>(result))),
              within);
  }
}

TEST(Bspline, RefusesIntervalsThatAreNoClampedCubic) {
  for (const char* text :
       {"BSPLINE SD=3 X1 PL=1\nX2 PL=0\n", "BSPLINE X1 PL=1\nX2 PL=0\nX3 PL=1\n",
        "BSPLINE X1 PL=0\nX2 PL=0\nX3 PL=0\n", "BSPLINE X1 PL=0\nX2 PL=1\nX3 PL=0\nX4 PL=0\n"}) {
    EXPECT_EQ(refusal_of(read_bspline(parsed(text), 0, starting_at(Point3::Zero()), kAccepted)),
              "PL of the blocks is no clamped cubic")
        << text;
  }
  for (const char* text : {"G1 X1\n", "BSPLINE SD=2 X1 PL=1\n", "BSPLINE X1\n"}) {
    EXPECT_EQ(refusal_of(read_bspline(parsed(text), 0, starting_at(Point3::Zero()), kAccepted)),
              "no BSPLINE")
        << text;
  }
}

}  // namespace
}  // namespace batten::gcode
