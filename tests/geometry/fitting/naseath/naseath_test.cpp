#include "geometry/fitting/naseath/naseath.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/path/parameter_samples.h"
#include "tests/support/naseath_cases.h"
#include "tests/support/noisy_curves.h"

namespace batten::geometry {
namespace {

void expect_no_worse(const BsplineCurve& after, const BsplineCurve& before) {
  EXPECT_LE(greatest_curvature(after), greatest_curvature(before) * (1 + 1e-8));
}

// At a thousand places, with no help of the library's bounds.
double greatest_displacement(const BsplineCurve& a, const BsplineCurve& b) {
  double most = 0;
  for (int i = 0; i <= 1000; ++i) {
    const double u = a.first() + (a.last() - a.first()) * i / 1000;
    most = std::max(most, (a.point_at(u) - b.point_at(u)).norm());
  }
  return most;
}

TEST(Naseath, TurnsWithTheCurveIntoSpace) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vector3(1, 2, -0.5).normalized()).toRotationMatrix();
  const Vector3 shift(3, -7, 11);
  for (const auto& options : {literal(.125), repaired(.125)}) {
    for (const std::string name : {"G1", "G2", "G3", "tc6"}) {
      SCOPED_TRACE(name);
      const BsplineCurve flat = curve_of_case(name);
      std::vector<Point3> points = flat.control_points();
      for (Point3& p : points) p = turn * p + shift;
      const NaseathResult of_flat = smooth_naseath(flat, options);
      const NaseathResult of_turned = smooth_naseath({flat.basis(), points}, options);
      EXPECT_EQ(of_turned.passes, of_flat.passes);
      std::vector<Point3> expected = of_flat.curve.control_points();
      for (Point3& p : expected) p = turn * p + shift;
      EXPECT_LE(farthest(of_turned.curve.control_points(), expected), 1e-8);
    }
  }
}

// After 200 passes, as the table has it; it ends after 983 with points moved by .248 mm.
TEST(Naseath, AddsWavesToASawtoothLiterallyAndNoneWithRepairs) {
  const BsplineCurve line = line_with_sawtooth();
  NaseathOptions options = literal(.25);
  options.max_passes = 200;
  const BsplineCurve waves = smooth_naseath(line, options).curve;
  EXPECT_NEAR(farthest(waves.control_points(), line.control_points()), .19, .005);
  EXPECT_NEAR(greatest_curvature(line), 3e-7, .5e-7);
  EXPECT_NEAR(greatest_curvature(waves), 1e-2, .2e-2);

  const NaseathResult result = smooth_naseath(line, repaired(.25));
  expect_no_worse(result.curve, line);
  EXPECT_LE(result.displacement, 1e-5);
}

TEST(Naseath, BendsCurvesHarderLiterallyAndNotWithRepairs) {
  struct Row {
    std::string name;
    BsplineCurve curve;
    double before;
    std::vector<std::pair<double, double>> table;  // radius, greatest curvature
    double precision;
  };
  const Row rows[] = {
      {"noisy helix",
       helix_with_two_wrong_points(),
       .0678,
       {{.025, .0680}, {.125, .0687}, {.25, .0696}},
       6e-5},
      {"U", u_shaped_curve(), .393, {{.25, .395}, {1, .400}, {2, .407}, {4, .416}}, 6e-4},
  };
  for (const auto& [name, curve, before, table, precision] : rows) {
    EXPECT_NEAR(greatest_curvature(curve), before, precision) << name;
    for (const auto& [radius, expected] : table) {
      SCOPED_TRACE(testing::Message() << name << ", radius " << radius);
      EXPECT_NEAR(greatest_curvature(smooth_naseath(curve, literal(radius)).curve), expected,
                  precision);
      expect_no_worse(smooth_naseath(curve, repaired(radius)).curve, curve);
    }
  }
  const BsplineCurve g3 = curve_of_case("G3");
  EXPECT_GT(greatest_curvature(smooth_naseath(g3, literal(.25)).curve), .060);
  expect_no_worse(smooth_naseath(g3, repaired(.25)).curve, g3);
}

// A line with noise that the tube holds.
BsplineCurve noisy_line(int seed, double peak) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> noise(-peak, peak);
  std::vector<Point3> points;
  for (int i = 0; i < 30; ++i) points.emplace_back(3.4 * i, i > 0 && i < 29 ? noise(random) : 0, 0);
  return natural_cubic_through(points);
}

TEST(Naseath, EndsOnALineWithNoiseBelowTheRadius) {
  int endless = 0;
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve line = noisy_line(seed, .2);
    NaseathOptions options = literal(.25);
    options.max_passes = 300;
    endless += smooth_naseath(line, options).stop == NaseathStop::kPassLimit;
    const NaseathResult result = smooth_naseath(line, repaired(.25));
    EXPECT_LT(result.passes, 500);
    EXPECT_LT(greatest_curvature(result.curve), 0.3 * greatest_curvature(line));
  }
  EXPECT_GT(endless, 0) << "the literal method always ended: the test does not test";
}

BsplineCurve random_curve(int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> step(0, 1);
  std::uniform_real_distribution<double> width(0.3, 3);
  std::vector<double> knots = {0};
  std::vector<Point3> points = {Point3::Zero()};
  const int size = 5 + seed % 20;
  while (static_cast<int>(points.size()) < size) {
    const Vector3 across(step(random), step(random), seed % 2 ? step(random) : 0);
    points.push_back(points.back() + Vector3(2, 0, 0) + across);
  }
  while (knots.size() + 2 < points.size()) knots.push_back(knots.back() + width(random));
  return {BsplineBasis::clamped(3, knots), points};
}

TEST(Naseath, StaysInTheTubeAndBendsNoHarder) {
  for (int seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const BsplineCurve curve = random_curve(seed);
    const double radius = std::pow(10.0, -3.0 + seed % 4);
    NaseathOptions options = repaired(radius);
    options.held_points = seed % 5 == 0 ? 2 : 0;
    const NaseathResult result = smooth_naseath(curve, options);
    EXPECT_LE(result.displacement, radius);
    EXPECT_LE(greatest_displacement(curve, result.curve), result.displacement * (1 + 1e-9));
    expect_no_worse(result.curve, curve);
    EXPECT_EQ(static_cast<int>(result.remaining.size()), result.passes + 1);
  }
}

TEST(Naseath, ExactBoundAloneHoldsTheTubeWhereFiveSamplesDoNot) {
  const BsplineCurve curve = curve_of_case("tc5a");
  const double radius = .125;
  EXPECT_GT(greatest_displacement(curve, smooth_naseath(curve, literal(radius)).curve),
            1.04 * radius);
  NaseathOptions options = literal(radius);
  options.repairs.exact_bound = true;
  EXPECT_LE(greatest_displacement(curve, smooth_naseath(curve, options).curve), radius);
}

TEST(Naseath, GoesOnWhereTheTubeIsNotTouched) {
  const BsplineCurve curve = curve_of_case("tc6");
  NaseathOptions global = repaired(.25);
  global.repairs.local_stop = false;
  const auto mean = [](const BsplineCurve& of) {
    return mean_curvature(parameter_samples(of, kNaseathSteps));
  };
  const double before = mean(curve);
  const double with_global = mean(smooth_naseath(curve, global).curve);
  const double with_local = mean(smooth_naseath(curve, repaired(.25)).curve);
  EXPECT_LT(with_local, with_global - 0.01 * before);
}

TEST(Naseath, HeldPointsStay) {
  const BsplineCurve curve = curve_of_case("tc5b");
  for (const int held : {1, 2, 3}) {
    for (NaseathOptions options : {literal(.125), repaired(.125)}) {
      options.held_points = held;
      const auto points = smooth_naseath(curve, options).curve.control_points();
      const std::size_t m = points.size();
      for (std::size_t i = 0; i < static_cast<std::size_t>(held); ++i) {
        EXPECT_EQ(points[i], curve.control_points()[i]);
        EXPECT_EQ(points[m - 1 - i], curve.control_points()[m - 1 - i]);
      }
      EXPECT_NE(points[10], curve.control_points()[10]);
    }
  }
}

TEST(Naseath, LeavesAStraightLineAlone) {
  const BsplineCurve line =
      uniform_cubic({{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {3, 6, 9}, {5, 10, 15}});
  for (const auto& options : {literal(.25), repaired(.25)}) {
    const NaseathResult result = smooth_naseath(line, options);
    EXPECT_EQ(result.stop, NaseathStop::kNothingToMove);
    EXPECT_EQ(result.passes, 0);
    EXPECT_EQ(result.curve.control_points(), line.control_points());
  }
}

TEST(Naseath, RefusesWhatItCannotSmooth) {
  const BsplineCurve line = curve_of_case("G1");
  for (const int wrong : {0, 1, 2, 3}) {
    NaseathOptions options = repaired(wrong == 0 ? 0 : .1);
    if (wrong == 1) options.accuracy = 0;
    if (wrong == 2) options.precision = 0;
    if (wrong == 3) options.max_passes = 0;
    EXPECT_THROW((void)smooth_naseath(line, options), std::invalid_argument) << wrong;
  }
  const std::vector<Point3>& points = line.control_points();
  const BsplineBasis quadratic(2, {0, 0, 0, 1, 2, 3, 4, 5, 5, 5});
  const BsplineBasis with_corner(3, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2});
  const BsplineBasis unclamped(3, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
  for (const BsplineBasis& basis : {quadratic, with_corner, unclamped}) {
    EXPECT_THROW((void)smooth_naseath({basis, points}, repaired(.1)), std::invalid_argument);
  }
}

// A ring begins where its curve does, and what is held there keeps it without a seam, also where
// its turns all agree, so that no group of them has an end of its own: an oval, and one with
// ripples.
TEST(NaseathRing, StaysWithoutASeam) {
  for (const double ripple : {0.0, 0.04}) {
    std::vector<Point3> points;
    std::vector<double> breakpoints = {0};
    for (int i = 0; i < 24; ++i) {
      const double a = i * kPi / 12;
      const double r = 1 + (i % 2 == 0 && i > 6 && i < 18 ? ripple : 0);
      points.emplace_back(30 * r * std::cos(a), 20 * r * std::sin(a), 0);
      breakpoints.push_back(i + 1);
    }
    const BsplineCurve ring = ring_of(breakpoints, points);
    for (const NaseathOptions& options : {literal(0.25, 3), repaired(0.25, 3)}) {
      const NaseathResult result = smooth_naseath(ring, options);
      const BsplineCurve& made = result.curve;
      EXPECT_LE((made.point_at(0) - ring.point_at(0)).norm(), 1e-12);
      for (const int order : {0, 1, 2}) {
        EXPECT_LE((made.derivative_at(0, order) - made.derivative_at(24, order)).norm(), 1e-9);
      }
      EXPECT_LE(result.displacement, 1.05 * options.radius);
    }
    const BsplineCurve made = smooth_naseath(ring, repaired(0.25, 3)).curve;
    const double before = greatest_curvature(ring);
    EXPECT_LE(greatest_curvature(made), (ripple > 0 ? 0.85 : 1 + 1e-9) * before);
  }
}

}  // namespace
}  // namespace batten::geometry
