#include "geometry/fitting/corners/guo_corner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>
#include <variant>

#include "tests/support/corners.h"

namespace batten::geometry {
namespace {

constexpr double kLong = 1e3;  // mm, legs that limit nothing

CornerFrame frame_at(double half_angle_degrees) {
  return std::get<CornerFrame>(frame_of(corner_of(half_angle_degrees, kLong, kLong)));
}

// The example of the paper: delta 0.01, theta 35 degrees, L 0.0479. It prints epsilon .0173,
// e0 .0195, alpha .256, L* .0123, from rounded intermediate values.
TEST(GuoCorner, GivesTheWorkedExampleOfThePaper) {
  const auto whole_leg = corner_of(35, 2 * 0.0479, 1);
  const auto of = [](const Corner& corner, double tolerance, GuoApex apex) {
    return std::get<GuoBlend>(guo_corner(corner, {tolerance, ToleranceKind::kBand, apex}));
  };
  const double e0 = guo_blend(frame_at(35), 0.0479).blend.deviation.corner;
  EXPECT_NEAR(e0, 0.0196187, 1e-6);
  EXPECT_NEAR(0.005 / e0, 0.254859, 1e-6);
  const GuoBlend allowed = of(corner_of(35, kLong, kLong), 0.01, GuoApex::kAllowed);
  EXPECT_NEAR(allowed.blend.deviation.corner, 0.0174345, 1e-6);
  EXPECT_NEAR(of(whole_leg, 0.01, GuoApex::kHalfTolerance).spacing, 0.0122077, 1e-6);
  // Where the tolerance allows all of the leg.
  EXPECT_NEAR(of(whole_leg, 0.02, GuoApex::kHalfTolerance).spacing, 0.0479, 1e-12);
}

class GuoAngles : public testing::TestWithParam<int> {};

TEST_P(GuoAngles, ClosedFormsAreWhatTheCurveDoes) {
  const double spacing = 0.7;
  const CornerFrame frame = frame_at(GetParam());
  const GuoBlend guo = guo_blend(frame, spacing);
  const BsplineCurve& curve = guo.blend.curve;
  const double e = (curve.point_at(0.5) - frame.vertex).norm();

  const auto sampled = sampled_deviation(curve, corner_of(GetParam(), kLong, kLong));
  EXPECT_NEAR(sampled.legs, e * frame.sin_half, 1e-9);
  EXPECT_NEAR(guo.blend.deviation.legs, sampled.legs, 1e-9);
  EXPECT_NEAR(guo.blend.deviation.corner, sampled.corner, 1e-9);
  EXPECT_NEAR(guo.blend.deviation.in_order, sampled.in_order, 1e-9);

  double greatest = 0;
  for (int i = 0; i <= 2000; ++i) greatest = std::max(greatest, curve.curvature_at(i / 2000.0));
  EXPECT_NEAR(guo.greatest_curvature / greatest, 1, 1e-9);
  EXPECT_NEAR(curve.curvature_at(0.5) / greatest, 1, 1e-9);

  // Slope of the curvature by length, over a stretch of 1e-6 of the parameter.
  const double step = 1e-6;
  const double along = step * curve.derivative_at(0, 1).norm();
  // sin 2 theta / (18 L^2): the curvature is 0 at both ends, as on the legs.
  const double slope = 2 * frame.sin_half * frame.cos_half / (18 * spacing * spacing);
  EXPECT_NEAR(curve.curvature_at(step) / along / slope, 1, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(HalfAngle, GuoAngles, testing::Values(5, 15, 25, 35, 45, 60, 75, 85));

TEST(GuoCorner, HasTheLengthsOfItsShape) {
  const double expected[][2] = {{5, 3.0204},  {15, 3.1266}, {35, 3.4417}, {45, 3.6043},
                                {60, 3.8133}, {75, 3.9517}, {85, 3.9946}};
  for (const auto& [half_angle, length] : expected) {
    const GuoBlend guo = guo_blend(frame_at(half_angle), 2.0);
    double sum = 0;
    for (const CubicBezier& piece : guo.blend.curve.bezier_pieces()) sum += length_of(piece);
    EXPECT_NEAR(sum / 2.0 / length, 1, 1e-4) << half_angle;
  }
}

// A tangent arc with its apex at delta / sin theta from the corner has the curvature
// (1 - sin theta) / delta.
TEST(GuoCorner, BendsHarderThanAnArcBySoMuch) {
  const double expected[][2] = {{45, 1.61}, {35, 1.83}};
  for (const auto& [half_angle, ratio] : expected) {
    const GuoRule rule{0.1, ToleranceKind::kBand, GuoApex::kAllowed};
    const auto guo = std::get<GuoBlend>(guo_corner(corner_of(half_angle, kLong, kLong), rule));
    const double arc = (1 - std::sin(half_angle * kDegrees)) / 0.1;
    EXPECT_NEAR(guo.greatest_curvature / arc, ratio, 0.005);
  }
}

// In the band reading the corner itself is further away: 1.41 tolerances at a square corner,
// 5.76 where the legs are 20 degrees apart.
TEST(GuoCorner, UsesTheWholeToleranceInEitherReading) {
  for (const int half_angle : {2, 10, 35, 45, 60, 85}) {
    const Corner corner = corner_of(half_angle, 1e5, 1e5);
    const double sine = std::sin(half_angle * kDegrees);
    const auto band = std::get<GuoBlend>(guo_corner(corner, {0.1, ToleranceKind::kBand}));
    EXPECT_NEAR(sampled_deviation(band.blend.curve, corner).legs, 0.1, 1e-9);
    EXPECT_NEAR(sampled_deviation(band.blend.curve, corner).corner, 0.1 / sine, 1e-8);
    const auto path = std::get<GuoBlend>(guo_corner(corner, {0.1, ToleranceKind::kPath}));
    EXPECT_NEAR(sampled_deviation(path.blend.curve, corner).in_order, 0.1, 1e-9);
  }
}

TEST(GuoCorner, HasOneSecondDerivativeAtItsInnerKnot) {
  const auto halves = guo_blend(frame_at(40), 1).blend.curve.bezier_pieces();
  ASSERT_EQ(halves.size(), 2u);
  const auto& l = halves[0].control;
  const auto& r = halves[1].control;
  EXPECT_LT(((l[3] - l[2]) - (r[1] - r[0])).norm(), 1e-13);
  EXPECT_LT(((l[3] - 2 * l[2] + l[1]) - (r[2] - 2 * r[1] + r[0])).norm(), 1e-13);
}

TEST(GuoCorner, HoldsItsPromisesAnywhereInSpace) {
  std::mt19937 random(1);
  for (int seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "corner " << seed);
    std::uniform_real_distribution<double> unit(0, 1);
    const double half_angle = 1 + 88 * unit(random);
    const double before = std::pow(10, -1 + 3 * unit(random));
    const double after = std::pow(10, -1 + 3 * unit(random));
    const GuoRule rule{std::pow(10, -3 + 3 * unit(random)),
                       seed % 2 ? ToleranceKind::kPath : ToleranceKind::kBand};
    const Corner flat = corner_of(half_angle, before, after);
    const Motion motion = random_motion(random);
    const Corner corner = motion(flat);
    const auto guo = std::get<GuoBlend>(guo_corner(corner, rule));
    const BsplineCurve& curve = guo.blend.curve;

    const auto sampled = sampled_deviation(curve, corner, 500);
    EXPECT_LE(deviation_of(sampled, rule.kind), rule.tolerance * (1 + 1e-9) + 1e-12);
    EXPECT_LE(2 * guo.spacing, std::min(before, after) + 1e-12);
    const JointMeasure joints = measure_joints(curve, corner);
    EXPECT_LT(joints.off_leg, 1e-12);
    EXPECT_LT(joints.turn, 1e-9);
    EXPECT_LT(joints.curvature, 1e-9 * guo.greatest_curvature);

    const auto plane = std::get<GuoBlend>(guo_corner(flat, rule));
    const auto back = std::get<GuoBlend>(guo_corner(turned_back(corner), rule));
    for (int i = 0; i <= 10; ++i) {
      const Point3 p = curve.point_at(i / 10.0);
      EXPECT_LT((motion(plane.blend.curve.point_at(i / 10.0)) - p).norm(), 1e-10);
      EXPECT_LT((back.blend.curve.point_at(1 - i / 10.0) - p).norm(), 1e-10);
      // Inside the triangle of its control points: a + b coordinates, neither negative.
      const auto frame = std::get<CornerFrame>(frame_of(flat));
      const Point3 q = plane.blend.curve.point_at(i / 10.0);
      const double x = -q.x() / frame.cos_half;  // sum of the coordinates along a and b
      const double y = q.y() / frame.sin_half;   // their difference
      EXPECT_LE(std::abs(y), x + 1e-10);
      EXPECT_LE(x, 2 * plane.spacing + 1e-10);
    }
  }
}

TEST(GuoCorner, TakesNoMoreThanItsShareOfEachLeg) {
  const Corner corner = corner_of(45, 10, 10);
  const GuoRule rule{5, ToleranceKind::kBand};
  EXPECT_NEAR(std::get<GuoBlend>(guo_corner(corner, rule, 3, 4)).spacing, 1.5, 1e-12);
  EXPECT_NEAR(std::get<GuoBlend>(guo_corner(corner, rule, 4, 2)).spacing, 1, 1e-12);
  EXPECT_NEAR(std::get<GuoBlend>(guo_corner(corner, rule, 400, 200)).spacing, 5, 1e-12);
  EXPECT_EQ(std::get<NoBlend>(guo_corner(corner, rule, 400, 0)), NoBlend::kNoRoom);
}

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

TEST(GuoCorner, HasNoBlendAndAReasonAtDegenerateCorners) {
  const std::pair<Corner, NoBlend> rows[] = {
      {{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}}, NoBlend::kStraight},
      {{{0, 0, 0}, {1, 0, 0}, {2, 1e-10, 0}}, NoBlend::kStraight},
      {{{0, 0, 0}, {1, 2, 3}, {0, 0, 0}}, NoBlend::kReversal},
      {{{0, 0, 0}, {1, 0, 0}, {0, 1e-10, 0}}, NoBlend::kReversal},
      {{{1, 1, 1}, {1, 1, 1}, {2, 1, 1}}, NoBlend::kNoLeg},
      {{{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}, NoBlend::kNoLeg},
      {{{1e-9, 0, 0}, {0, 0, 0}, {0, 1e-9, 0}}, NoBlend::kNoLeg},
      {{{1.5e-9, 0, 0}, {0, 0, 0}, {0, 1.5e-9, 0}}, NoBlend::kNoRoom},
      {{{kNotANumber, 0, 0}, {0, 0, 0}, {0, 1, 0}}, NoBlend::kNoLeg}};
  for (const auto& [corner, reason] : rows) {
    SCOPED_TRACE(testing::Message()
                 << corner.before.transpose() << " to " << corner.after.transpose());
    for (const ToleranceKind kind : {ToleranceKind::kPath, ToleranceKind::kBand}) {
      const auto outcome = guo_corner(corner, {0.01, kind});
      ASSERT_TRUE(std::holds_alternative<NoBlend>(outcome));
      EXPECT_EQ(std::get<NoBlend>(outcome), reason);
    }
  }
}

TEST(GuoCorner, RefusesAToleranceThatIsNone) {
  for (const double tolerance : {0.0, -0.01, kNotANumber, 1 / 0.0}) {
    EXPECT_THROW(static_cast<void>(guo_corner(corner_of(45, 1, 1), {tolerance})),
                 std::invalid_argument);
  }
}

}  // namespace
}  // namespace batten::geometry
