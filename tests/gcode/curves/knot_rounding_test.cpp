#include <gtest/gtest.h>

#include <cmath>

#include "gcode/curves/curve_print.h"
#include "tests/support/curve_texts.h"

namespace batten::gcode {
namespace {

using geometry::BsplineBasis;
using geometry::BsplineCurve;

// The golden curve with another inner knot.
BsplineCurve with_inner_knot(double knot) {
  return {BsplineBasis::clamped(3, {0, knot, 1}), curve_tests::golden_curve().control_points()};
}

TEST(KnotRounding, TakesTheFewestStepsThatAreEnough) {
  // 1/3 in 100 steps is 0.33: the joint of the pieces, 24 mm from the start, slides by some 0.1 mm.
  const BsplineCurve curve = with_inner_knot(1.0 / 3);
  for (const auto& [enough, last] : {std::pair(1.0, 100.0), {0.05, 1e3}, {0.005, 1e4}}) {
    const auto printed = print_knots(curve, {}, enough);
    ASSERT_TRUE(printed);
    EXPECT_EQ(printed->knots.back(), last) << enough;
    EXPECT_EQ(printed->knots[4], std::floor(last / 3));
    EXPECT_EQ(printed->decimals, 0);
    EXPECT_LE(printed->move, enough);
  }
}

TEST(KnotRounding, UsesDecimalsBehindTheDigitsBeforeThePoint) {
  const auto printed = print_knots(with_inner_knot(1.0 / 3), {.digits = 9, .decimals = 3}, 1e-7);
  ASSERT_TRUE(printed);
  EXPECT_EQ(printed->decimals, 3);
  EXPECT_EQ(printed->knots.back(), 100000);
  EXPECT_EQ(printed->knots[4], 33333.333);
}

TEST(KnotRounding, SaysHowFarTheCurveMoves) {
  const BsplineCurve curve = with_inner_knot(0.337);
  const auto printed = print_knots(curve, {.digits = 3, .decimals = 0}, 1e-9);
  ASSERT_TRUE(printed);
  EXPECT_EQ(printed->knots[4], 34);
  // As far as the curve with the rounded knot says itself.
  const BsplineCurve rounded = with_inner_knot(0.34);
  EXPECT_NEAR(printed->move, greatest_move(curve.bezier_pieces(), rounded.bezier_pieces()), 1e-12);
  EXPECT_GT(printed->move, 0.01);
}

TEST(KnotRounding, KeepsDistinctKnotsApart) {
  const BsplineCurve close(BsplineBasis::clamped(3, {0, 0.5, 0.5 + 1e-5, 1}),
                           {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 1, 0}, {4, 0, 0}, {5, 0, 0}});
  const auto printed = print_knots(close, {}, 1000);
  ASSERT_TRUE(printed);
  EXPECT_EQ(printed->knots.back(), 1e5);
  EXPECT_EQ(printed->knots[5] - printed->knots[4], 1);
  EXPECT_FALSE(print_knots(close, {.digits = 5, .decimals = 0}, 1000));
}

TEST(KnotRounding, KeepsEqualKnotsEqual) {
  // Two that differ by noise are one: a double knot.
  const BsplineCurve curve(BsplineBasis(3, {0, 0, 0, 0, 0.3, 0.1 + 0.2, 1, 1, 1, 1}),
                           {{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {3, 1, 0}, {4, 0, 0}, {5, 0, 0}});
  const auto printed = print_knots(curve, {}, 1e-4);
  ASSERT_TRUE(printed);
  EXPECT_EQ(printed->knots[4], 30);
  EXPECT_EQ(printed->knots[5], 30);
}

}  // namespace
}  // namespace batten::gcode
