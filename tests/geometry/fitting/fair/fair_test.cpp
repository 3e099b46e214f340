#include "geometry/fitting/fair/fair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <ostream>
#include <random>
#include <vector>

#include "geometry/distance/path_distance.h"
#include "geometry/path/curve_pieces.h"
#include "tests/support/paths.h"

namespace batten::geometry {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

FairOptions with_tolerance(double tolerance) {
  FairOptions options;
  options.tolerance = tolerance;
  return options;
}

// Curvature of the circle through three places: four times their area over the product of the
// sides.
double curvature_through(const Point3& a, const Point3& b, const Point3& c) {
  const double area2 = (b - a).cross(c - a).norm();
  return 2 * area2 / ((b - a).norm() * (c - b).norm() * (a - c).norm());
}

double greatest_curvature(const std::vector<Point3>& points) {
  double greatest = 0;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    greatest = std::max(greatest, curvature_through(points[i - 1], points[i], points[i + 1]));
  }
  return greatest;
}

// Sampled in every span, 16 places each, and at both ends.
double greatest_curvature(const BsplineCurve& curve) {
  double greatest = curve.curvature_at(curve.last());
  const std::vector<double> breaks = curve.breakpoints();
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (int k = 0; k < 16; ++k) {
      const double u = breaks[i] + (breaks[i + 1] - breaks[i]) * k / 16;
      greatest = std::max(greatest, curve.curvature_at(u));
    }
  }
  return greatest;
}

Vector3 curvature_vector(const BsplineCurve& curve, double u) {
  const Vector3 d1 = curve.derivative_at(u, 1);
  const Vector3 d2 = curve.derivative_at(u, 2);
  const double speed2 = d1.squaredNorm();
  return (d2 - d2.dot(d1) / speed2 * d1) / speed2;
}

bool is_proved(const std::vector<Point3>& points, const BsplineCurve& curve, double tolerance) {
  return compare_paths(path_through(points), beziers_of(curve), tolerance).verdict ==
         Verdict::kProved;
}

// --- the path that was meant -----------------------------------------------------------------

// Root of the mean of squared distances over the length, `count` places per polyline edge.
struct MeanSquare {
  double sum = 0;
  double length = 0;
  void add(double distance, double step) {
    sum += distance * distance * step;
    length += step;
  }
  [[nodiscard]] double root() const { return std::sqrt(sum / length); }
};

TEST(SmoothCurve, OfASurfaceProgramIsNearerToTheSurfaceThanItsChords) {
  MeanSquare chords;
  MeanSquare fair;
  for (int row = 0; row < 8; ++row) {
    const std::vector<Point3> points = FinishSurface::row(10 + 0.2 * row, 0.005);
    const auto path = fair_path(points, with_tolerance(0.01));
    ASSERT_TRUE(path);
    constexpr int kParts = 40;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const double step = (points[i + 1] - points[i]).norm() / kParts;
      const double u = path->vertex_parameters[i];
      const double width = path->vertex_parameters[i + 1] - u;
      for (int k = 0; k < kParts; ++k) {
        const double t = (k + 0.5) / kParts;
        chords.add(FinishSurface::distance(points[i] + t * (points[i + 1] - points[i])), step);
        fair.add(FinishSurface::distance(path->curve.point_at(u + t * width)), step);
      }
    }
  }
  RecordProperty("chords_nm", static_cast<int>(1e6 * chords.root()));
  RecordProperty("fair_nm", static_cast<int>(1e6 * fair.root()));
  // Chords of constant curvature whose greatest distance is 0.005 have sqrt(8/15) of it.
  EXPECT_NEAR(chords.root(), 0.0035, 0.0003);
  EXPECT_LE(fair.root(), 0.5 * 0.0035);
}

// --- noise falls -----------------------------------------------------------------------------

TEST(SmoothCurve, OfANoisyLineIsStraight) {
  const auto points = zigzag_line(100, 0.5, 0.03);
  // Neighbours 0.06 apart across: the circle through (-.5, -.03), (0, .03), (.5, -.03) has
  // curvature 2 h / (h^2 + l^2) with h = 0.06, l = 0.5.
  EXPECT_NEAR(greatest_curvature(points), 0.12 / (0.06 * 0.06 + 0.25), 1e-9);
  const auto path = fair_path(points, with_tolerance(0.05));
  ASSERT_TRUE(path);
  RecordProperty("curvature_nano", static_cast<int>(1e9 * greatest_curvature(path->curve)));
  EXPECT_LE(greatest_curvature(path->curve), 1e-6);
}

TEST(SmoothCurve, OfANoisyHalfCircleIsNearlyTheCircle) {
  const auto points = noisy_half_circle(20, 400, 0.03);
  // As for the line with steps of 20 pi / 400, and the curvature of the circle on top.
  const double step = 20 * std::numbers::pi / 400;
  EXPECT_NEAR(greatest_curvature(points), 0.12 / (0.06 * 0.06 + step * step) + 0.05, 0.01);
  const auto path = fair_path(points, with_tolerance(0.05));
  ASSERT_TRUE(path);
  const double greatest = greatest_curvature(path->curve);
  RecordProperty("curvature_micro", static_cast<int>(1e6 * greatest));
  EXPECT_LE(greatest, 0.06);
  EXPECT_GE(greatest, 0.049);  // a half circle cannot be flatter than 1 / 20.05 throughout
}

TEST(SmoothCurve, AddsNothingToALineWithoutNoise) {
  const auto path = fair_path(zigzag_line(100, 0.5, 1e-6), with_tolerance(0.25));
  ASSERT_TRUE(path);
  // The circle through three neighbours: 2 h / l^2, h = 2e-6, l = 0.5.
  EXPECT_LE(greatest_curvature(path->curve), 1.6e-5);
}

// A flat and a slope, both cut into blocks of 5 mm, and between them a rounding of 8 mm in chords
// of 0.25 mm, to four decimals. The last chord ends on the slope, 0.4 um beside it, where a CAM
// system ends a chord of 1 um beyond the joint. The curve does not swing out along either: with
// such blocks taken for samples of a curve it leaves them by 7 um.
TEST(SmoothCurve, StaysOnLinesThatAreCutIntoBlocksBesideARounding) {
  const auto rounded = [](double x, double z) {
    return Point3(std::round(x * 1e4) / 1e4, 0, std::round(z * 1e4) / 1e4);
  };
  std::vector<Point3> points;
  for (int i = 0; i <= 6; ++i) points.push_back(rounded(5 * i, 0));
  constexpr int kChords = 25;
  const double turn = 45 * kDegree;
  for (int i = 1; i <= kChords; ++i) {
    points.push_back(
        rounded(30 + 8 * std::sin(turn * i / kChords), 8 - 8 * std::cos(turn * i / kChords)));
  }
  const Point3 joint(30 + 8 * std::sin(turn), 0, 8 - 8 * std::cos(turn));
  points.back().z() += 4e-4;
  for (const double x : {5.1234, 10.1234, 15.1234, 20.1234, 24.0}) {
    points.push_back(rounded(joint.x() + x, joint.z() + x));
  }
  FairOptions options = with_tolerance(0.01);
  options.rounding = 5e-5;
  options.accurate = true;
  const auto path = fair_path(points, options);
  ASSERT_TRUE(path);
  double off = 0;
  for (double u = path->curve.first(); u < path->curve.last(); u += 0.05) {
    const Point3 p = path->curve.point_at(u);
    if (p.x() < 29) off = std::max(off, std::abs(p.z()));
    if (p.x() > joint.x() + 1.5)
      off = std::max(off, std::abs(p.z() - joint.z() - p.x() + joint.x()));
  }
  EXPECT_LT(off, 7e-4);
}

// The same rounding in coarse chords among noise of 8 um, in a band of 30 um. Taken for samples of
// a curve, the blocks would leave it so much room that it swings by 20 um between two of them.
TEST(SmoothCurve, RunsStraightAlongLinesAmongNoise) {
  double squares = 0;
  double squares_of_chords = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const std::vector<Point3> points = noisy_rounding(0.008, seed);
    FairOptions options = with_tolerance(0.03);
    options.accurate = true;
    const auto path = fair_path(points, options);
    ASSERT_TRUE(path);
    double off = 0;
    for (double u = path->curve.first(); path->curve.point_at(u).x() < -1; u += 0.05) {
      const double z = path->curve.point_at(u).z();
      off = std::max(off, std::abs(z));
      squares += 0.05 * z * z;
    }
    EXPECT_LT(off, 0.009);
    for (std::size_t i = 0; i < 6; ++i) {
      const double a = points[i].z();
      const double b = points[i + 1].z();
      squares_of_chords += 5 * (a * a + a * b + b * b) / 3;
    }
  }
  EXPECT_LT(std::sqrt(squares / squares_of_chords), 0.9);
}

// Vertices 0.5 mm apart on a wave, each off by up to 8 um, in a band of 30 um: the curve is nearer
// to the wave than they are, not as far off as the band allows.
TEST(SmoothCurve, AmongLittleNoiseIsNearerToThePathThanTheVertices) {
  const auto wave = [](double x) { return 3 * std::sin(x / 4.8); };
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> off(-0.008, 0.008);
    std::vector<Point3> points;
    for (int i = 0; i <= 120; ++i) points.emplace_back(0.5 * i, 0, wave(0.5 * i) + off(random));
    FairOptions options = with_tolerance(0.03);
    options.accurate = true;
    const auto path = fair_path(points, options);
    ASSERT_TRUE(path);
    double squares = 0;
    int places = 0;
    for (double u = path->curve.first(); u < path->curve.last(); u += 0.05, ++places) {
      const Point3 p = path->curve.point_at(u);
      squares += std::pow(p.z() - wave(p.x()), 2);
    }
    EXPECT_LT(std::sqrt(squares / places), 0.8 * 0.008 / std::sqrt(3)) << seed;
  }
}

// A square of 20 mm in steps of 0.4 mm, normal noise across its sides that is more than twice the
// tolerance.
std::vector<Point3> noisy_square(double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> off(0, noise);
  std::vector<Point3> points = {Point3::Zero()};
  Point3 corner = Point3::Zero();
  for (int side = 0; side < 4; ++side) {
    const Vector3 along(std::cos(90 * side * kDegree), std::sin(90 * side * kDegree), 0);
    for (int i = 1; i <= 50; ++i) {
      const Vector3 across(-along.y(), along.x(), 0);
      points.emplace_back(corner + 0.4 * i * along + (i < 50 ? off(random) : 0) * across);
    }
    corner = points.back();
  }
  return points;
}

// The corners stay where they are, to within the tolerance; the sides get none. A vertex 3.5
// deviations off between two others that far off on the other side makes 2 (3.5 + 3.5) 0.01 / 0.4^2
// of curvature, less what the tolerance takes; a curve bends up to three times as hard.
TEST(SmoothCurve, OfANoisySquareHasItsFourCornersAndNoOthers) {
  constexpr double kOff = 0.01;
  constexpr double kTight = 0.004;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const auto points = noisy_square(kOff, seed);
    const auto path = fair_path(points, with_tolerance(kTight));
    ASSERT_TRUE(path);
    EXPECT_LE(path->deviation, kTight);
    double beside = 0;
    for (double u = 0.05; u < path->curve.last(); u += 0.05) {
      const Point3 place = path->curve.point_at(u);
      double nearest = HUGE_VAL;
      for (const Point3& corner :
           {Point3(0, 0, 0), Point3(20, 0, 0), Point3(20, 20, 0), Point3(0, 20, 0)}) {
        nearest = std::min(nearest, (place - corner).norm());
      }
      if (nearest > 0.4) beside = std::max(beside, path->curve.curvature_at(u));
    }
    for (const std::size_t corner : {50, 100, 150}) {
      const double u = path->vertex_parameters[corner];
      EXPECT_LE((path->curve.point_at(u) - points[corner]).norm(), kTight);
      EXPECT_GE(greatest_curvature(path->curve), 1 / (10 * kTight));
    }
    EXPECT_LE(beside, 3 * 2 * (7 * kOff - kTight) / (0.4 * 0.4));
  }
}

// --- corners and lines -----------------------------------------------------------------------

TEST(SmoothCurve, KeepsLongLinesOfASlotExactlyStraight) {
  const auto points = slot_path(50, 8, 60);
  for (const double tolerance : {0.01, 0.05}) {
    SCOPED_TRACE(testing::Message() << "tolerance " << tolerance);
    const auto path = fair_path(points, with_tolerance(tolerance));
    ASSERT_TRUE(path);
    const auto& at = path->vertex_parameters;
    const std::size_t start = 61;  // of the upper line
    for (const double t : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const double u = at[start] + t * (at[start + 1] - at[start]);
      EXPECT_LE(path->curve.curvature_at(u), 1e-9) << t;
      EXPECT_NEAR(path->curve.point_at(u).y(), 8, 1e-9) << t;
    }
  }
}

TEST(SmoothCurve, RoundsACornerInsideTheBandWithContinuousCurvature) {
  for (const double turn : {20.0, 60.0, 90.0, 120.0, 150.0}) {
    SCOPED_TRACE(testing::Message() << "turn " << turn);
    const Vector3 leg(30 * std::cos(turn * kDegree), 30 * std::sin(turn * kDegree), 0);
    const std::vector<Point3> points = {Point3(-30, 0, 0), Point3::Zero(), leg};
    const double tolerance = 0.02;
    const auto path = fair_path(points, with_tolerance(tolerance));
    ASSERT_TRUE(path);
    EXPECT_EQ(path->kept_corners, 0);
    EXPECT_TRUE(is_proved(points, path->curve, tolerance));
    // A knot where the curvature jumps would show a difference that does not shrink with the step.
    const std::vector<double> breaks = path->curve.breakpoints();
    for (std::size_t i = 1; i + 1 < breaks.size(); ++i) {
      const double step = 1e-9 * path->curve.last();
      const Vector3 jump = curvature_vector(path->curve, breaks[i] + step) -
                           curvature_vector(path->curve, breaks[i] - step);
      const Vector3 turned =
          path->curve.direction_at(breaks[i] + step) - path->curve.direction_at(breaks[i] - step);
      EXPECT_LE(jump.norm(), 1e-3 * greatest_curvature(path->curve)) << "at " << breaks[i];
      EXPECT_LE(turned.norm(), 1e-4);
    }
    // The legs far from the corner are left alone.
    EXPECT_LE(path->curve.curvature_at(15), 1e-9);
    EXPECT_LE(path->curve.curvature_at(45), 1e-9);
  }
}

// The arc that touches both legs and passes the corner at the tolerance has the radius
// tolerance / (sqrt 2 - 1). A curve that swings wide before and after is flatter.
TEST(SmoothCurve, RoundsACornerFlatterThanTheArcBetweenItsLegs) {
  const std::vector<Point3> points = {Point3(-30, 0, 0), Point3::Zero(), Point3(0, 30, 0)};
  for (const double tolerance : {0.1, 0.03, 0.01, 0.003, 0.001}) {
    const auto path = fair_path(points, with_tolerance(tolerance));
    ASSERT_TRUE(path);
    EXPECT_LE(greatest_curvature(path->curve), (std::numbers::sqrt2 - 1) / tolerance) << tolerance;
  }
}

TEST(SmoothCurve, KeepsCornersThatTurnMoreThanAskedExactly) {
  const auto points = staircase_path(3, 10);
  FairOptions options = with_tolerance(0.05);
  options.keep_corner_angle = 80 * kDegree;
  const auto path = fair_path(points, options);
  ASSERT_TRUE(path);
  EXPECT_EQ(path->kept_corners, 3);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_LE((path->curve.point_at(path->vertex_parameters[i]) - points[i]).norm(), 1e-12);
  }
  options.keep_corner_angle = 100 * kDegree;
  const auto rounded = fair_path(points, options);
  ASSERT_TRUE(rounded);
  EXPECT_EQ(rounded->kept_corners, 0);
}

TEST(SmoothCurve, KeepsAReversal) {
  const std::vector<Point3> points = {Point3(0, 0, 0), Point3(20, 0, 0), Point3(5, 0.01, 0),
                                      Point3(5, 10, 0)};
  const auto path = fair_path(points, with_tolerance(0.05));
  ASSERT_TRUE(path);
  EXPECT_EQ(path->kept_corners, 1);
  EXPECT_LE((path->curve.point_at(path->vertex_parameters[1]) - points[1]).norm(), 1e-12);
  EXPECT_TRUE(is_proved(points, path->curve, 0.05));
}

// --- closed runs -----------------------------------------------------------------------------

struct ClosedCase {
  const char* name;
  std::vector<Point3> points;
  double tolerance;
};

void PrintTo(const ClosedCase& test, std::ostream* out) { *out << test.name; }

class ClosedRun : public testing::TestWithParam<ClosedCase> {};

TEST_P(ClosedRun, HasNoSeam) {
  const ClosedCase& test = GetParam();
  const auto path = fair_path(test.points, with_tolerance(test.tolerance));
  ASSERT_TRUE(path);
  const BsplineCurve& curve = path->curve;
  EXPECT_EQ(curve.point_at(curve.first()), curve.point_at(curve.last()));
  EXPECT_EQ(path->kept_corners, 0);
  const Vector3 turned = curve.direction_at(curve.last()) - curve.direction_at(curve.first());
  const Vector3 jump =
      curvature_vector(curve, curve.last()) - curvature_vector(curve, curve.first());
  EXPECT_LE(turned.norm(), kCornerAngle);
  EXPECT_LE(jump.norm(), 0.03 * greatest_curvature(curve));
}

std::vector<Point3> noisy_circle() {
  auto points = circle_path(20, 400);
  for (std::size_t i = 1; i + 1 < points.size(); ++i) points[i] *= 1 + (i % 2 ? 1 : -1) * 0.0015;
  return points;
}

std::vector<Point3> wavy_ring() {
  return greedy_chords(
      [](double a) {
        const double r = 25 + 2 * std::cos(5 * a);
        return Point3(r * std::cos(a), r * std::sin(a), std::sin(3 * a));
      },
      0.0, 2 * std::numbers::pi, 0.005, 3);
}

INSTANTIATE_TEST_SUITE_P(SmoothCurve, ClosedRun,
                         testing::Values(ClosedCase{"Circle", circle_path(20, 200), 0.01},
                                         ClosedCase{"FewChords", circle_path(2, 24), 0.05},
                                         ClosedCase{"NoisyCircle", noisy_circle(), 0.05},
                                         ClosedCase{"WavyRing", wavy_ring(), 0.01}),
                         [](const auto& test) { return test.param.name; });

// Rings of radius 1 to 30 with chords of 0.1 mm and four decimals, their seam at a knot or beside
// one. Vertices that the rounding, e, moves up, down and up again lie on a circle of curvature
// 4 e / chord^2 = 0.02; three times that is allowed beyond the ring's own.
TEST(ClosedRunOfManyChords, BendsNoHarderAtItsSeamThanItsVerticesDo) {
  constexpr double kChord = 0.1;
  constexpr double kRounding = 5e-5;
  for (int radius = 1; radius <= 30; ++radius) {
    const int chords = static_cast<int>(2 * std::numbers::pi * radius / kChord);
    std::vector<Point3> points;
    for (int i = 0; i < chords; ++i) {
      const double angle = 2 * std::numbers::pi * i / chords;
      points.push_back(printed(radius * Point3(std::cos(angle), std::sin(angle), 0), 4));
    }
    points.push_back(points.front());
    FairOptions options = with_tolerance(0.01);
    options.rounding = kRounding;
    for (const bool accurate : {false, true}) {
      options.accurate = accurate;
      const auto path = fair_path(points, options);
      ASSERT_TRUE(path);
      EXPECT_LE(greatest_curvature(path->curve),
                1.0 / radius + 3 * 4 * kRounding / (kChord * kChord))
          << "radius " << radius << (accurate ? ", accurate" : "");
    }
  }
}

// --- small runs ------------------------------------------------------------------------------

TEST(SmoothCurve, OfTwoPointsIsTheLine) {
  const std::vector<Point3> points = {Point3(1, 2, 3), Point3(11, 2, 3)};
  const auto path = fair_path(points, with_tolerance(0.01));
  ASSERT_TRUE(path);
  EXPECT_EQ(path->curve.point_at(path->curve.first()), points[0]);
  EXPECT_EQ(path->curve.point_at(path->curve.last()), points[1]);
  EXPECT_LE(greatest_curvature(path->curve), 1e-12);
  EXPECT_LE(path->deviation, 1e-12);
}

TEST(SmoothCurve, GoesThroughRepeatedPlacesOnce) {
  const Point3 a(0, 0, 0);
  const Point3 b(5, 0, 0);
  const Point3 c(5, 5, 0);
  const std::vector<Point3> points = {a, a, b, b, b, c, c};
  const auto path = fair_path(points, with_tolerance(0.01));
  ASSERT_TRUE(path);
  const auto& at = path->vertex_parameters;
  ASSERT_EQ(at.size(), points.size());
  EXPECT_EQ(at[0], path->curve.first());
  EXPECT_EQ(at[1], at[0]);
  EXPECT_EQ(at[2], at[4]);
  EXPECT_EQ(at[5], path->curve.last());
  EXPECT_EQ(at[6], path->curve.last());
}

TEST(SmoothCurve, OfOnePlaceIsNothing) {
  const std::vector<Point3> points(5, Point3(1, 2, 3));
  EXPECT_FALSE(fair_path(points, {}));
}

TEST(SmoothCurve, RefusesWhatHasNoMeaning) {
  const std::vector<Point3> two = {Point3::Zero(), Point3(1, 0, 0)};
  EXPECT_THROW((void)fair_path(std::vector<Point3>{Point3::Zero()}, {}), std::invalid_argument);
  EXPECT_THROW((void)fair_path(two, with_tolerance(0)), std::invalid_argument);
  EXPECT_THROW((void)fair_path(two, with_tolerance(-1)), std::invalid_argument);
}

// --- the machine's need ----------------------------------------------------------------------

// Chords of circles of radius 0.3 at 6000 mm/min and 500 mm/s^2 across: the machine holds only
// sqrt(500 * 0.3) = 12 mm/s of 100, so a wider path wins time, unless the user wants none of it.
TEST(SmoothCurve, GivesTheToleranceToFeedUnlessItShallBeAccurate) {
  std::vector<Point3> points;
  for (int i = 0; i <= 400; ++i) {
    const double x = 0.05 * i;
    points.emplace_back(x, 0.02 * std::sin(4 * x), 0);
  }
  FairOptions options = with_tolerance(0.015);
  options.feed = 6000;
  options.acceleration = 500;
  const auto fast = fair_path(points, options);
  options.accurate = true;
  const auto accurate = fair_path(points, options);
  ASSERT_TRUE(fast && accurate);
  EXPECT_GT(fast->rounds, 0);
  EXPECT_EQ(accurate->rounds, 0);
  EXPECT_LT(greatest_curvature(fast->curve), 0.7 * greatest_curvature(accurate->curve));
  EXPECT_LE(accurate->noise, 2 * options.rounding);
}

// --- long runs -------------------------------------------------------------------------------

std::vector<Point3> noisy_long_run() {
  std::mt19937 random(2);
  std::normal_distribution<double> off(0, 0.001);
  std::vector<Point3> points;
  for (int i = 0; i <= 6000; ++i) {
    const double x = 0.25 * i;
    const double z = 3 * std::sin(x / 6) + 0.8 * std::sin(x / 2.3) + off(random);
    points.push_back(printed(Point3(x, 0, z), 3));
  }
  return points;
}

// Where a vertex is moved, the curve moves only beside it.
TEST(SmoothCurve, AVertexIsFeltOverTwoHundredVerticesAtTheMost) {
  const std::vector<Point3> points = noisy_long_run();
  std::vector<Point3> other = points;
  constexpr double kTolerance = 0.01;
  constexpr std::size_t kFelt = 200;  // vertices on either side
  constexpr std::size_t kMoved = 3000;
  other[kMoved].z() += 0.004;
  const auto before = fair_path(points, with_tolerance(kTolerance));
  const auto after = fair_path(other, with_tolerance(kTolerance));
  ASSERT_TRUE(before && after);
  double near = 0;
  double far = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double off = (before->curve.point_at(before->vertex_parameters[i]) -
                        after->curve.point_at(after->vertex_parameters[i]))
                           .norm();
    const std::size_t away = i > kMoved ? i - kMoved : kMoved - i;
    double& most = away > kFelt ? far : near;
    most = std::max(most, off);
  }
  EXPECT_GT(near, 1e-4);
  EXPECT_LE(far, 0.01 * kTolerance);
}

}  // namespace
}  // namespace batten::geometry
