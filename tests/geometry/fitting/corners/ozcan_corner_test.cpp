#include "geometry/fitting/corners/ozcan_corner.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <variant>

#include "geometry/distance/path_distance.h"
#include "geometry/fitting/corners/guo_corner.h"
#include "tests/support/corners.h"

namespace batten::geometry {
namespace {

// The corner of the paper: A(0,0) C(13,13) B(26,0), P1 .. P3 at (10,10), (10.75,10.75),
// (11.5,11.5), F 25 mm/s, A 2500 and 3000 mm/s^2, J 5000 mm/s^3.
Corner paper_corner() { return {{0, 0, 0}, {13, 13, 0}, {26, 0, 0}}; }
CornerFrame paper_frame() { return std::get<CornerFrame>(frame_of(paper_corner())); }
OzcanLeg paper_leg() {
  const double r = std::sqrt(2.0);
  return {3 * r, 2.25 * r, 1.5 * r};
}
KinematicLimits paper_limits() { return {}; }

BesideLeg beside(const CornerFrame& frame, const Point3& p) {
  const Vector3 from = p - frame.vertex;
  return {from.dot(frame.a), from.dot(frame.outward_a())};
}

// The paper's corner with P4 there and P5 its mirror image.
BsplineCurve curve_with(double x, double y) {
  const BesideLeg fourth = beside(paper_frame(), {x, y, 0});
  return ozcan_curve(paper_frame(), paper_leg(), fourth);
}

Point3 fourth_point(const BsplineCurve& curve) { return curve.control_points()[3]; }

double greatest_curvature(const BsplineCurve& curve) {
  double found = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i <= kSamples; ++i) {
    const double u = curve.first() + (curve.last() - curve.first()) * i / kSamples;
    found = std::max(found, curve.curvature_at(u));
  }
  return found;
}

// Of the corner's whole path: the blend and what it leaves of the legs, 10 sqrt 2 each.
double path_length(const BsplineCurve& curve) {
  double sum = 20 * std::sqrt(2.0);
  for (const CubicBezier& piece : curve.bezier_pieces()) sum += length_of(piece);
  return sum;
}

const OzcanBlend& blend_of(const std::variant<OzcanBlend, NoBlend>& outcome) {
  return std::get<OzcanBlend>(outcome);
}

TEST(OzcanCorner, HasThePointsOfThePaperOnTheLegs) {
  const auto points = curve_with(12.67, 12.95).control_points();
  const Point3 expected[] = {{10, 10, 0},       {10.75, 10.75, 0}, {11.5, 11.5, 0},
                             {12.67, 12.95, 0}, {13.33, 12.95, 0}, {14.5, 11.5, 0},
                             {15.25, 10.75, 0}, {16, 10, 0}};
  ASSERT_EQ(points.size(), 8u);
  for (int i = 0; i < 8; ++i) EXPECT_LT((points[i] - expected[i]).norm(), 1e-12) << i;
}

// C(2.5) = (P3 + 23 P4 + 23 P5 + P6) / 48.
TEST(OzcanCorner, HasItsMiddleWhereTheBasisFunctionsSay) {
  const BsplineCurve curve = curve_with(12.67, 12.95);
  const auto& p = curve.control_points();
  const Point3 expected = (p[2] + 23 * p[3] + 23 * p[4] + p[5]) / 48;
  EXPECT_LT((curve.point_at(2.5) - expected).norm(), 1e-13);
}

// Deviation from the legs, feed estimate, greatest curvature and length of the points as they are
// printed, with two decimals. So "usual" misses the tolerance 0.05 by 2 % and "optimum" 0.1 by
// 2.3 %, the latter outside of the corner.
TEST(OzcanCorner, PrintedControlPointsHaveTheirFigures) {
  struct Row {
    const char* name;
    double x, y;
    double deviation, feed, curvature, length;
  };
  for (const auto& [name, x, y, deviation, feed, curvature, length] :
       {Row{"usual, .1", 12.92, 12.92, .0984, 4.695, 6.29, 36.6056},
        {"optimum, .1", 12.67, 12.95, .1023, 9.324, 2.34, 36.6997},
        {"usual, .05", 12.99, 12.99, .0510, 3.499, 9.92, 36.6875},
        {"optimum, .05", 12.86, 12.99, .0510, 5.567, 4.93, 36.7092}}) {
    SCOPED_TRACE(name);
    const BsplineCurve curve = curve_with(x, y);
    const BlendDeviation found = measure_blend(curve, paper_frame());
    const double estimate = feed_estimate(curve, paper_limits());
    fmt::print("{:16} P4 ({:.2f}, {:.2f}) off legs {:.4f} off corner {:.4f} feed {:7.4f} mm/s\n",
               name, x, y, found.legs, found.corner, estimate);
    EXPECT_NEAR(found.legs / deviation, 1, 1e-3);
    EXPECT_NEAR(estimate / feed, 1, 1e-3);
    EXPECT_NEAR(greatest_curvature(curve), curvature, 0.005);
    EXPECT_NEAR(path_length(curve), length, 0.00006);
  }
}

TEST(OzcanCorner, LeavesTheBandWherePrintedOptimaDo) {
  // The printed optimum of 0.1 is farthest at (13.647, 12.498), on the outside of the leg.
  const BsplineCurve curve = curve_with(12.67, 12.95);
  double away = 0;
  Point3 where = Point3::Zero();
  for (int i = 0; i <= 20000; ++i) {
    const Point3 p = curve.point_at(i / 4000.0);
    const double here = std::min(segment_distance(p, {0, 0, 0}, {13, 13, 0}),
                                 segment_distance(p, {13, 13, 0}, {26, 0, 0}));
    if (here > away && p.x() > 13) {
      away = here;
      where = p;
    }
  }
  EXPECT_NEAR(where.x(), 13.647, 1e-3);
  EXPECT_NEAR(where.y(), 12.498, 1e-3);
  EXPECT_GT(where.x() + where.y(), 26);  // above the leg x + y = 26
}

// y of the middle is (11.5 + 23 p) / 24 for P4 = (p, p), and the legs are 45 degrees steep, so
// p = (24 (13 - tolerance sqrt 2) - 11.5) / 23: 12.9176 and 12.9914, printed 12.92 and 12.99.
TEST(OzcanCorner, GivesTheUsualPointsOfThePaper) {
  for (const double tolerance : {0.1, 0.05}) {
    const double p = (24 * (13 - tolerance * std::sqrt(2.0)) - 11.5) / 23;
    const auto usual = blend_of(
        ozcan_usual({paper_frame(), paper_leg(), tolerance, ToleranceKind::kBand, paper_limits()}));
    EXPECT_LT((fourth_point(usual.blend.curve) - Point3(p, p, 0)).norm(), 1e-9);
    EXPECT_NEAR(usual.blend.deviation.legs, tolerance, 1e-9);
    EXPECT_LE(usual.blend.deviation.legs, tolerance);
    const double printed = tolerance == 0.1 ? 12.92 : 12.99;
    EXPECT_NEAR(fourth_point(usual.blend.curve).x(), printed, 0.005);
  }
}

OzcanBlend paper_optimum(double tolerance, ToleranceKind kind) {
  return blend_of(ozcan_optimum({paper_frame(), paper_leg(), tolerance, kind, paper_limits()}));
}

// Printed: (12.67, 12.95) for 0.1, which breaks the tolerance, and (12.86, 12.99) for 0.05.
TEST(OzcanCorner, FindsTheOptimumOfThePaperInsideTheTolerance) {
  const OzcanBlend wide = paper_optimum(0.1, ToleranceKind::kBand);
  EXPECT_LE(wide.blend.deviation.legs, 0.1);
  EXPECT_GE(wide.feed_estimate, 10.15);
  EXPECT_NEAR(wide.feed_estimate / 10.229, 1, 1e-3);
  EXPECT_NEAR(fourth_point(wide.blend.curve).x(), 12.635, 0.001);
  EXPECT_NEAR(fourth_point(wide.blend.curve).y(), 12.918, 0.001);
  EXPECT_NEAR(wide.blend.deviation.corner, 0.1414, 0.0001);

  const OzcanBlend narrow = paper_optimum(0.05, ToleranceKind::kBand);
  EXPECT_LE(narrow.blend.deviation.legs, 0.05);
  EXPECT_GE(narrow.feed_estimate, 5.55);
  EXPECT_NEAR(narrow.feed_estimate / 5.579, 1, 1e-3);
  EXPECT_NEAR(fourth_point(narrow.blend.curve).x(), 12.86, 0.005);
  EXPECT_NEAR(fourth_point(narrow.blend.curve).y(), 12.99, 0.005);
  for (const auto* blend : {&wide, &narrow}) {
    fmt::print("optimum P4 ({:.4f}, {:.4f}) feed {:.4f} mm/s\n",
               fourth_point(blend->blend.curve).x(), fourth_point(blend->blend.curve).y(),
               blend->feed_estimate);
  }
}

TEST(OzcanCorner, FindsWhatAGridOfAllPlacesFinds) {
  for (const ToleranceKind kind : {ToleranceKind::kBand, ToleranceKind::kPath}) {
    const double found = paper_optimum(0.1, kind).feed_estimate;
    double best = 0;
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 60; ++j) {  // x from 12.5 to 12.9, y from 12.85 to 13
        const BsplineCurve curve = curve_with(12.5 + 0.01 * i, 12.85 + 0.0025 * j);
        if (measure_deviation(curve, paper_frame(), kind) > 0.1) continue;
        best = std::max(best, feed_estimate(curve, paper_limits()));
      }
    }
    EXPECT_GE(found, best);
    EXPECT_LT(found, 1.03 * best);  // a grid that fine misses the top by a few percent
  }
}

// The order of the paper's times; the feeds stand for them (no times are planned here).
TEST(OzcanCorner, IsTheFasterTheMoreIsOptimised) {
  for (const double tolerance : {0.1, 0.05}) {
    const ToleranceKind kind = ToleranceKind::kBand;
    const double usual =
        blend_of(ozcan_usual({paper_frame(), paper_leg(), tolerance, kind, paper_limits()}))
            .feed_estimate;
    const double guo =
        feed_estimate(std::get<GuoBlend>(guo_corner(paper_corner(), {tolerance, kind})).blend.curve,
                      paper_limits());
    const double optimum = paper_optimum(tolerance, kind).feed_estimate;
    const double own =
        blend_of(ozcan_corner(paper_corner(), tolerance, kind, paper_limits())).feed_estimate;
    fmt::print(
        "tolerance {:4} feeds: usual {:.3f}, five points {:.3f}, optimum {:.3f}, "
        "with legs of its own {:.3f} mm/s\n",
        tolerance, usual, guo, optimum, own);
    EXPECT_LT(usual, guo);
    EXPECT_LT(guo, optimum);
    EXPECT_LT(optimum, own);
  }
}

TEST(OzcanCorner, KeepsTheCornerWithinTheToleranceInThePathReading) {
  const OzcanBlend blend = paper_optimum(0.1, ToleranceKind::kPath);
  EXPECT_LE(blend.blend.deviation.in_order, 0.1);
  EXPECT_NEAR(blend.blend.deviation.corner, 0.1, 1e-4);
  EXPECT_LT(blend.feed_estimate, paper_optimum(0.1, ToleranceKind::kBand).feed_estimate);
  // The sharpest curve with the paper's legs is 1.5 / 24 = 0.0625 mm from the corner.
  const auto narrow =
      ozcan_optimum({paper_frame(), paper_leg(), 0.05, ToleranceKind::kPath, paper_limits()});
  EXPECT_EQ(std::get<NoBlend>(narrow), NoBlend::kNoRoom);
}

// How long the legs should be: the reason for 0.35 in ozcan_legs.
TEST(OzcanCorner, ChoosesLegsNearTheBestOnes) {
  const double parts[] = {0.1, 0.2, 0.3, 0.35, 0.4, 0.5, 0.7, 0.95};
  KinematicLimits limits = paper_limits();
  limits.feed = 1000;
  fmt::print("half angle, reading; feed for legs whose sharpest curve uses");
  for (const double part : parts) fmt::print(" {}", part);
  fmt::print(" of 0.1 mm\n");
  for (const int half_angle : {20, 45, 70}) {
    for (const ToleranceKind kind : {ToleranceKind::kBand, ToleranceKind::kPath}) {
      const Corner corner = corner_of(half_angle, 100, 100);
      const CornerFrame frame = std::get<CornerFrame>(frame_of(corner));
      const double own = blend_of(ozcan_corner(corner, 0.1, kind, limits)).feed_estimate;
      double best = 0;
      fmt::print("{} {}:", half_angle, kind == ToleranceKind::kBand ? "band" : "path");
      for (const double part : parts) {
        const double sine = kind == ToleranceKind::kBand ? frame.sin_half : 1;
        const double d = 24 * part * 0.1 / (frame.cos_half * sine);
        const OzcanLeg leg{2 * d, 1.5 * d, d};
        const double feed = blend_of(ozcan_optimum({frame, leg, 0.1, kind, limits})).feed_estimate;
        fmt::print(" {:.2f}", feed);
        best = std::max(best, feed);
      }
      fmt::print("\n");
      EXPECT_GT(own, 0.75 * best);
    }
  }
}

struct RandomCorner {
  Corner flat;
  double tolerance;
  ToleranceKind kind;
  double share;
};

RandomCorner random_corner(std::mt19937& random, int seed) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double half_angle = 5 + 80 * unit(random);
  const double before = std::pow(10, -1 + 2.5 * unit(random));
  const double after = seed % 3 == 0 ? before : std::pow(10, -1 + 2.5 * unit(random));
  const double tolerance = std::pow(10, -3 + 2 * unit(random));
  return {corner_of(half_angle, before, after), tolerance,
          seed % 2 ? ToleranceKind::kPath : ToleranceKind::kBand, std::min(0.5 * before, after)};
}

TEST(OzcanCorner, HoldsItsPromisesAnywhereInSpace) {
  std::mt19937 random(6);
  KinematicLimits limits;
  limits.feed = 1000;
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "corner " << seed);
    const RandomCorner given = random_corner(random, seed);
    const Corner corner = random_motion(random)(given.flat);
    const auto outcome = ozcan_corner(corner, given.tolerance, given.kind, limits, given.share);
    const OzcanBlend& blend = blend_of(outcome);
    const BsplineCurve& curve = blend.blend.curve;

    const auto sampled = sampled_deviation(curve, corner, 3000);
    // Samples miss the place nearest to the vertex, and maxima that are kinks, by a little.
    EXPECT_LE(deviation_of(sampled, given.kind), given.tolerance * (1 + 1e-5));
    EXPECT_LE(sampled.legs, blend.blend.deviation.legs * (1 + 1e-9));
    EXPECT_NEAR(sampled.legs, blend.blend.deviation.legs, 5e-3 * given.tolerance);
    EXPECT_NEAR(sampled.corner, blend.blend.deviation.corner, 1e-3 * given.tolerance);
    const JointMeasure joints = measure_joints(curve, corner);
    EXPECT_LT(joints.off_leg, 1e-12);
    EXPECT_LT(joints.turn, 1e-9);
    EXPECT_LT(joints.curvature, 1e-6 * greatest_curvature(curve));
    EXPECT_LE((curve.point_at(0) - corner.vertex).norm(), given.share + 1e-12);
    EXPECT_LE((curve.point_at(5) - corner.vertex).norm(), given.share + 1e-12);

    if (given.kind == ToleranceKind::kPath) {
      Path path = {Line{corner.before, curve.point_at(0)}};
      for (const CubicBezier& piece : curve.bezier_pieces()) path.emplace_back(piece);
      path.emplace_back(Line{curve.point_at(5), corner.after});
      const Path sharp = {Line{corner.before, corner.vertex}, Line{corner.vertex, corner.after}};
      EXPECT_EQ(compare_paths(sharp, path, 1.03 * given.tolerance).verdict, Verdict::kProved);
    }
  }
}

// The search is never worse than where it started. The knots stay simple: C2 inside.
TEST(OzcanCorner, IsNeverSlowerThanTheUsualOne) {
  std::mt19937 random(7);
  KinematicLimits limits;
  limits.feed = 1000;
  int faster = 0;
  for (int seed = 0; seed < 20; ++seed) {
    const RandomCorner given = random_corner(random, seed);
    const auto frame = std::get<CornerFrame>(frame_of(given.flat));
    const OzcanLeg leg = ozcan_leg(frame, given.tolerance, given.kind, given.share);
    const auto usual = blend_of(ozcan_usual({frame, leg, given.tolerance, given.kind, limits}));
    const auto best = blend_of(ozcan_optimum({frame, leg, given.tolerance, given.kind, limits}));
    EXPECT_GE(best.feed_estimate, usual.feed_estimate);
    faster += best.feed_estimate > 1.2 * usual.feed_estimate;
    EXPECT_EQ(best.blend.curve.basis().knots(), usual.blend.curve.basis().knots());
    EXPECT_EQ(best.blend.curve.breakpoints().size(), 6u);
  }
  EXPECT_GE(faster, 15);
}

// The usual corner takes no notice of the axes, so it turns with the corner. The optimum does
// where axes and limits change places together.
TEST(OzcanCorner, TurnsWithTheCorner) {
  std::mt19937 random(8);
  KinematicLimits limits;
  limits.feed = 1000;
  KinematicLimits cycled = limits;  // x -> y -> z -> x
  cycled.acceleration =
      Vector3(limits.acceleration.z(), limits.acceleration.x(), limits.acceleration.y());
  Eigen::Matrix3d cycle;
  cycle << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  for (int seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "corner " << seed);
    const RandomCorner given = random_corner(random, seed);
    const auto frame = std::get<CornerFrame>(frame_of(given.flat));
    const OzcanLeg leg = ozcan_leg(frame, given.tolerance, given.kind, given.share);
    const Motion motion = random_motion(random);
    const auto turned = std::get<CornerFrame>(frame_of(motion(given.flat)));
    const auto usual = blend_of(ozcan_usual({frame, leg, given.tolerance, given.kind, limits}));
    const auto other = blend_of(ozcan_usual({turned, leg, given.tolerance, given.kind, limits}));
    EXPECT_NEAR(usual.fourth.along, other.fourth.along, 1e-9 * leg[0]);

    const auto best = blend_of(ozcan_optimum({frame, leg, given.tolerance, given.kind, limits}));
    const Motion axes{cycle, Vector3::Zero()};
    const auto moved = std::get<CornerFrame>(frame_of(axes(given.flat)));
    const auto again = blend_of(ozcan_optimum({moved, leg, given.tolerance, given.kind, cycled}));
    for (std::size_t i = 0; i < 8; ++i) {
      const Point3 expected = axes(best.blend.curve.control_points()[i]);
      EXPECT_LT((again.blend.curve.control_points()[i] - expected).norm(), 1e-3 * given.tolerance);
    }
    EXPECT_NEAR(again.feed_estimate / best.feed_estimate, 1, 1e-4);
  }
}

TEST(OzcanCorner, TurnsBackWithTheCorner) {
  std::mt19937 random(9);
  KinematicLimits limits;
  limits.feed = 1000;
  for (int seed = 0; seed < 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "corner " << seed);
    const RandomCorner given = random_corner(random, seed);
    const Corner corner = random_motion(random)(given.flat);
    const auto one =
        blend_of(ozcan_corner(corner, given.tolerance, given.kind, limits, given.share));
    const auto other = blend_of(
        ozcan_corner(turned_back(corner), given.tolerance, given.kind, limits, given.share));
    for (std::size_t i = 0; i < 8; ++i) {
      const Point3& p = one.blend.curve.control_points()[i];
      const Point3& q = other.blend.curve.control_points()[7 - i];
      EXPECT_LT((p - q).norm(), 1e-3 * given.tolerance);
    }
    EXPECT_NEAR(one.feed_estimate / other.feed_estimate, 1, 1e-4);
  }
}

// Lengths by k and tolerance by k: the same shape, and where jerk binds k^(2/3) of the feed.
TEST(OzcanCorner, ScalesWithTheCorner) {
  KinematicLimits limits;
  limits.feed = 1e6;
  limits.speed = limits.acceleration = Vector3::Constant(1e9);
  const auto one = blend_of(ozcan_corner(corner_of(40, 5, 50), 0.01, ToleranceKind::kPath, limits));
  const auto eight =
      blend_of(ozcan_corner(corner_of(40, 40, 400), 0.08, ToleranceKind::kPath, limits));
  EXPECT_NEAR(eight.feed_estimate / one.feed_estimate, 4, 1e-3);
}

// Short of degenerate, there are numbers.
TEST(OzcanCorner, IsFiniteAtTheLimits) {
  for (const double half_angle : {1e-6, 1e-3, 1.0, 89.0, 89.999, 89.999999}) {
    for (const double leg : {1e-6, 1.0, 1e4}) {
      for (const ToleranceKind kind : {ToleranceKind::kBand, ToleranceKind::kPath}) {
        SCOPED_TRACE(testing::Message() << half_angle << " degrees, leg " << leg);
        const Corner corner = corner_of(half_angle, leg, 0.3 * leg);
        const auto outcome = ozcan_corner(corner, 0.01, kind);
        const auto* blend = std::get_if<OzcanBlend>(&outcome);
        if (blend == nullptr) continue;
        EXPECT_LE(deviation_of(blend->blend.deviation, kind), 0.01);
        EXPECT_GT(blend->feed_estimate, 0);
        for (const Point3& p : blend->blend.curve.control_points()) EXPECT_TRUE(p.allFinite());
      }
    }
  }
}

TEST(OzcanCorner, RefusesAToleranceThatIsNone) {
  for (const double tolerance : {0.0, -1.0}) {
    EXPECT_THROW((void)ozcan_usual(
                     {paper_frame(), paper_leg(), tolerance, ToleranceKind::kBand, paper_limits()}),
                 std::invalid_argument);
  }
}

}  // namespace
}  // namespace batten::geometry
