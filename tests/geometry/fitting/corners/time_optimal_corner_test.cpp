#include "geometry/fitting/corners/time_optimal_corner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <variant>

#include "tests/support/corners.h"

namespace batten::geometry {
namespace {

// The square corner and the machine that the eight-point corner was published with.
Corner square_corner() { return {{0, 0, 0}, {13, 13, 0}, {26, 0, 0}}; }

TimeOptimalOptions options_for(double tolerance, ToleranceKind kind) {
  TimeOptimalOptions options;
  options.tolerance = tolerance;
  options.kind = kind;
  options.share_before = options.share_after = 1000;
  return options;
}

TimeOptimalBlend raced(const Corner& corner, const TimeOptimalOptions& options) {
  auto found = time_optimal_corner(corner, options);
  return std::get<TimeOptimalBlend>(std::move(found));
}

// Rest to rest over the whole square corner. Each leg has its ramp from 0 to 25 mm/s, with jerk
// 5000 sqrt(2) along it 2 sqrt(25/7071) s long, at 12.5 mm/s in the mean, and an even part.
double whole_time(const TimeOptimalBlend& blend) {
  const double leg = 13 * std::sqrt(2.0);
  const double ramp = 2 * std::sqrt(25 / (5000 * std::sqrt(2.0)));
  return blend.time + 2 * ramp + (2 * leg - blend.before - blend.after - 25 * ramp) / 25;
}

// Corners of all angles, turned into space, legs of different length.
struct SeededCorner {
  Corner corner;
  TimeOptimalOptions options;

  explicit SeededCorner(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(0, 1);
    const double half_angle = 10 + 75 * part(random);
    const double before = 8 + 30 * part(random);
    const double after = 8 + 30 * part(random);
    corner = random_motion(random)(corner_of(half_angle, before, after));
    options = options_for(std::pow(10, -2.5 + 2 * part(random)),
                          seed % 2 == 0 ? ToleranceKind::kBand : ToleranceKind::kPath);
    options.limits.feed = 10 + 40 * part(random);
    options.limits.jerk = Vector3(3000, 5000, 20000 * part(random) + 1000);
  }
};

TEST(TimeOptimalCorner, KeepsTheToleranceTheLegsAndTheMachinesLimitsInItsTime) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const SeededCorner given(seed);
    const TimeOptimalBlend blend = raced(given.corner, given.options);
    const BsplineCurve& curve = blend.blend.curve;
    const BlendDeviation sampled = sampled_deviation(curve, given.corner);
    EXPECT_LE(deviation_of(blend.blend.deviation, given.options.kind), given.options.tolerance);
    EXPECT_LE(deviation_of(sampled, given.options.kind), given.options.tolerance * (1 + 1e-6));
    const JointMeasure joints = measure_joints(curve, given.corner);
    EXPECT_LE(joints.off_leg, 1e-9);
    EXPECT_LE(joints.turn, 1e-9);
    EXPECT_LE(joints.curvature, 1e-9);
    EXPECT_NEAR(curve.last() - curve.first(), blend.time, 1e-12);
    EXPECT_LE(blend.load, 1);
    const KinematicLimits& limits = given.options.limits;
    constexpr int kPlaces = 1000;
    for (int i = 0; i <= kPlaces; ++i) {
      const double u = curve.first() + blend.time * i / kPlaces;
      EXPECT_LE(curve.derivative_at(u, 1).norm(), limits.feed * 1.001);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(std::abs(curve.derivative_at(u, 2)[axis]), limits.acceleration[axis] * 1.0001);
        EXPECT_LE(std::abs(curve.derivative_at(u, 3)[axis]), limits.jerk[axis] * 1.0001);
      }
    }
  }
}

TEST(TimeOptimalCorner, SwingsOutBeforeAndAfterAndInAtTheVertex) {
  const auto framed = frame_of(square_corner());
  const auto& frame = std::get<CornerFrame>(framed);
  for (const ToleranceKind kind : {ToleranceKind::kBand, ToleranceKind::kPath}) {
    const TimeOptimalBlend blend = raced(square_corner(), options_for(.1, kind));
    const BsplineCurve& curve = blend.blend.curve;
    double out_before = 0;
    double out_after = 0;
    constexpr int kPlaces = 1000;
    for (int i = 0; i <= kPlaces; ++i) {
      const double u = curve.first() + blend.time * i / kPlaces;
      const Vector3 off = curve.point_at(u) - frame.vertex;
      (i < kPlaces / 2 ? out_before : out_after) =
          i < kPlaces / 2 ? std::max(out_before, off.dot(frame.outward_a()))
                          : std::max(out_after, off.dot(frame.outward_b()));
    }
    EXPECT_GT(out_before, .05);
    EXPECT_GT(out_after, .05);
    const Vector3 apex = curve.point_at((curve.first() + curve.last()) / 2) - frame.vertex;
    EXPECT_LT(apex.dot(frame.outward_a()), -.05);
    EXPECT_LT(apex.dot(frame.outward_b()), -.05);
  }
}

// A machine that only knows accelerations: what it saves of a stop is bounded by the stop.
TEST(TimeOptimalCorner, NeedsNoJerkLimit) {
  TimeOptimalOptions options = options_for(.1, ToleranceKind::kBand);
  options.limits.acceleration = Vector3::Constant(500);
  options.limits.jerk = Vector3::Constant(std::numeric_limits<double>::infinity());
  const TimeOptimalBlend blend = raced(square_corner(), options);
  const BsplineCurve& curve = blend.blend.curve;
  for (int i = 0; i <= 1000; ++i) {
    const double u = curve.first() + blend.time * i / 1000;
    EXPECT_LE(curve.derivative_at(u, 2).cwiseAbs().maxCoeff(), 500 * 1.0001);
  }
  // A stop from 25 mm/s and back costs 25 / (500 sqrt 2) s more than passing; on an arc of the
  // radius that just touches the band, .1 / (1 - sin 45), one would pass with
  // sqrt(500 * .3414) = 13 mm/s, and save more than half.
  const double lost = blend.time - (blend.before + blend.after) / 25;
  EXPECT_GT(lost, 0);
  EXPECT_LT(lost, .5 * 25 / (500 * std::sqrt(2.0)));
}

TEST(TimeOptimalCorner, TravelledTheOtherWayTakesAsLong) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const SeededCorner given(seed);
    const double there = raced(given.corner, given.options).time;
    const double back = raced(turned_back(given.corner), given.options).time;
    EXPECT_NEAR(there, back, 2e-3 * there);
  }
}

TEST(TimeOptimalCorner, MoreToleranceIsFaster) {
  for (const ToleranceKind kind : {ToleranceKind::kBand, ToleranceKind::kPath}) {
    double before = 1.72;
    for (const double tolerance : {.001, .02, .1, .3}) {
      const double time = whole_time(raced(square_corner(), options_for(tolerance, kind)));
      EXPECT_LT(time, before);
      before = time;
    }
  }
}

TEST(TimeOptimalCorner, ShortLegsAreEnteredSlowly) {
  TimeOptimalOptions options = options_for(.1, ToleranceKind::kBand);
  options.share_before = .5;
  const TimeOptimalBlend blend = raced(square_corner(), options);
  EXPECT_NEAR(blend.before, .5, 1e-12);
  // From v it can stop within .5 mm: v sqrt(v/j) = .5, j = 5000 sqrt(2).
  EXPECT_NEAR(blend.speed_before, std::cbrt(.25 * 5000 * std::sqrt(2.0)), 1e-9);
  EXPECT_NEAR(blend.blend.curve.derivative_at(blend.blend.curve.first(), 1).norm(),
              blend.speed_before, 1e-9);
}

TEST(TimeOptimalCorner, SaysWhyACornerStays) {
  const TimeOptimalOptions options = options_for(.1, ToleranceKind::kPath);
  const auto why = [&](const Corner& corner, const TimeOptimalOptions& with) {
    const auto found = time_optimal_corner(corner, with);
    const auto* none = std::get_if<NoBlend>(&found);
    return none ? *none : throw std::runtime_error("a blend");
  };
  EXPECT_EQ(why({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}}, options), NoBlend::kNoLeg);
  EXPECT_EQ(why({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, options), NoBlend::kStraight);
  EXPECT_EQ(why({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, options), NoBlend::kReversal);
  TimeOptimalOptions narrow = options;
  narrow.share_after = 0;
  EXPECT_EQ(why(square_corner(), narrow), NoBlend::kNoRoom);
  TimeOptimalOptions boundless = options;
  boundless.limits.jerk.y() = boundless.limits.acceleration.y() =
      std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)time_optimal_corner(square_corner(), boundless), std::invalid_argument);
  narrow.tolerance = -1;
  EXPECT_THROW((void)time_optimal_corner(square_corner(), narrow), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
