#include "geometry/fitting/band_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/support/corners.h"

namespace batten::geometry {
namespace {

// --- known least energies ----------------------------------------------------------------------

BandSample ball(double u, const Point3& foot, double radius) {
  BandSample sample;
  sample.parameter = u;
  sample.foot = foot;
  sample.radius = radius;
  return sample;
}

BandSample along_x(double u, const Point3& foot, double radius) {
  BandSample sample = ball(u, foot, radius);
  sample.shape = BandShape::kCylinder;
  sample.direction = Vector3::UnitX();
  return sample;
}

// The straight line (x, 0, 0) with x the parameter.
std::vector<Point3> straight(const BsplineBasis& basis) {
  std::vector<Point3> points;
  for (std::size_t i = 0; i < basis.size(); ++i) points.emplace_back(basis.greville(i), 0, 0);
  return points;
}

BandProblem on_knots(std::vector<double> breaks, int energy) {
  return {BsplineBasis::clamped(3, breaks), energy, {}, {}, {}};
}

// A beam of length 2 on two supports, pushed down by d in the middle: its shape is a cubic on
// either side, and the integral of y''^2 is 48 d^2 / 2^3.
TEST(SolveBand, BendsAsABeamDoes) {
  for (const double radius : {0.75, 0.5, 0.1}) {
    SCOPED_TRACE(testing::Message() << "radius " << radius);
    BandProblem beam = on_knots({0, 1, 2}, 2);
    beam.samples = {along_x(1, {1, 1, 0}, radius)};
    beam.held = {HeldPoint::at(0, {0, 0, 0}), HeldPoint::at(4, {2, 0, 0})};
    const double d = 1 - radius;
    const BandCurve found = solve_band(beam, straight(beam.basis));
    EXPECT_EQ(found.end, BandEnd::kLeast);
    EXPECT_LT(found.worst_ratio, 1);
    EXPECT_GT(found.worst_ratio, 0.9999);
    EXPECT_NEAR(found.energy, 6 * d * d, 1e-4 * 6 * d * d);
    // y = d (3 u - u^3) / 2 up to the middle.
    EXPECT_NEAR(found.curve.point_at(0.5).y(), d * 0.6875, 1e-3 * d);
  }
}

TEST(SolveBand, WeightsMakeASpanStiff) {
  // Twice as stiff everywhere bends the same way with twice the energy.
  BandProblem beam = on_knots({0, 1, 2}, 2);
  beam.samples = {along_x(1, {1, 1, 0}, 0.5)};
  beam.held = {HeldPoint::at(0, {0, 0, 0}), HeldPoint::at(4, {2, 0, 0})};
  beam.weight = [](double) { return EnergyWeight{2, Vector3::Zero()}; };
  EXPECT_NEAR(solve_band(beam, straight(beam.basis)).energy, 3, 1e-3);
  // A stiff right half leaves the bending to the left.
  const auto bending = [](const BsplineCurve& curve, double u) {
    return curve.derivative_at(u, 2).squaredNorm();
  };
  beam.weight = [](double u) { return EnergyWeight{u < 1 ? 1.0 : 100.0, Vector3::Zero()}; };
  const BandCurve found = solve_band(beam, straight(beam.basis));
  EXPECT_LT(bending(found.curve, 1.5), 0.1 * bending(found.curve, 0.5));
}

// Run at uneven speed along x, a line has no energy across x.
TEST(SolveBand, EnergyAlongADirectionMayBeLeftOut) {
  BandProblem line = on_knots({0, 1, 2}, 2);
  std::vector<Point3> start = straight(line.basis);
  start[2].x() += 0.5;
  for (std::size_t i = 0; i < start.size(); ++i) line.held.push_back(HeldPoint::at(i, start[i]));
  const double all = solve_band(line, start).energy;
  line.weight = [](double) { return EnergyWeight{1, Vector3::UnitX()}; };
  EXPECT_LT(solve_band(line, start).energy, 0.01 * all);
  line.weight = [](double) { return EnergyWeight{1, Vector3::UnitY()}; };
  EXPECT_NEAR(solve_band(line, start).energy, all, 1e-9 * all);
}

TEST(SolveBand, HeldPointsGoWhereTheyMayOnly) {
  BandProblem beam = on_knots({0, 1, 2}, 2);
  beam.samples = {ball(1, {1, 1, 1}, 0.25)};
  beam.held = {HeldPoint::at(0, {0, 0, 0}),
               HeldPoint::on_plane(2, {1, 0, 0.125}, Vector3::UnitZ())};
  const BandCurve found = solve_band(beam, straight(beam.basis));
  const auto& points = found.curve.control_points();
  EXPECT_LE(points[0].norm(), 1e-15);
  EXPECT_NEAR(points[2].z(), 0.125, 1e-12);
  EXPECT_GT(points[2].y(), 0.1);
}

// Speed up, slow down and speed up again with one jerk: a way L from rest to rest in T needs
// 32 L / T^3.
TEST(LeastRatioInBand, IsTheJerkOfAMoveFromRestToRest) {
  BandProblem move = on_knots({0, 0.5, 1, 1.5, 2}, 3);
  const Point3 end(3, 0, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    move.held.push_back(HeldPoint::at(i, Point3::Zero()));
    move.held.push_back(HeldPoint::at(6 - i, end));
  }
  for (const double u : {0.25, 0.75, 1.25, 1.75}) {
    BandSample jerk = ball(u, Point3::Zero(), 1);
    jerk.shape = BandShape::kSlab;
    jerk.direction = Vector3::UnitX();
    jerk.derivative = 3;
    move.samples.push_back(jerk);
  }
  std::vector<Point3> start(7, Point3(1, 0, 0));
  const BandCurve found = least_ratio_in_band(move, start, 3);
  EXPECT_EQ(found.end, BandEnd::kLeast);
  EXPECT_NEAR(found.worst_ratio, 12, 1e-3 * 12);
  EXPECT_NEAR(found.curve.derivative_at(0.25, 3).x(), 12, 0.05);
  EXPECT_NEAR(found.curve.derivative_at(1, 3).x(), -12, 0.05);
}

// --- promises ----------------------------------------------------------------------------------

// A wavy run with noise, in space, with a sample every quarter of a span.
struct RandomBand {
  BandProblem problem;
  std::vector<Point3> start;

  explicit RandomBand(unsigned seed, double radius = 0.2, BandShape shape = BandShape::kBall,
                      int spans = 20)
      : problem{on_knots({0, 1}, 3)} {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-0.5, 0.5);
    std::vector<double> breaks;
    double at = 0;
    for (int i = 0; i <= spans; ++i) breaks.push_back(at += 1 + noise(random));
    problem = on_knots(breaks, 2 + static_cast<int>(seed % 2));
    std::vector<Point3> points = straight(problem.basis);
    for (Point3& p : points) p += 0.3 * Vector3(noise(random), noise(random), noise(random));
    const BsplineCurve path(problem.basis, points);
    for (int i = 0; i < spans; ++i) {
      for (const double part : {0.0, 0.25, 0.5, 0.75}) {
        const double u = breaks[i] + part * (breaks[i + 1] - breaks[i]);
        BandSample sample = ball(u, path.point_at(u), radius * (1 + noise(random)));
        sample.shape = shape;
        sample.direction = path.direction_at(u);
        problem.samples.push_back(sample);
      }
    }
    start = points;
  }
};

TEST(SolveBand, EndsInsideWithTheLeastEnergy) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomBand band(seed, 0.05);
    const BandCurve found = solve_band(band.problem, band.start);
    ASSERT_EQ(found.end, BandEnd::kLeast);
    EXPECT_LT(found.worst_ratio, 1);
    // The problem is convex: on the way to any other curve inside, the energy rises.
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 20; ++i) {
      BandProblem other = band.problem;
      const double wild = normal(random);
      other.weight = [wild](double u) {
        return EnergyWeight{std::exp(wild * std::sin(3 * u)), Vector3::Zero()};
      };
      const BandCurve away = solve_band(other, band.start);
      ASSERT_LT(away.worst_ratio, 1);
      double energy = 0;
      const auto breaks = away.curve.breakpoints();
      const int order = band.problem.energy;
      for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
        // Simpson's rule is exact for the square of a linear function.
        const double h = breaks[k + 1] - breaks[k];
        const Vector3 a = away.curve.derivative_at(breaks[k], order);
        const Vector3 m = away.curve.derivative_at(breaks[k] + h / 2, order);
        const Vector3 b = order == 3 ? a : Vector3(2 * m - a);
        energy += h / 6 * (a.squaredNorm() + 4 * m.squaredNorm() + b.squaredNorm());
      }
      EXPECT_GE(energy, found.energy * (1 - 2e-5));
    }
  }
}

TEST(SolveBand, FindsTheSameFromOutside) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomBand band(seed, 0.1);
    const BandCurve inside = solve_band(band.problem, band.start);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> off(-2, 2);
    for (Point3& p : band.start) p += Vector3(off(random), off(random), off(random));
    const BandCurve outside = solve_band(band.problem, band.start);
    ASSERT_EQ(outside.end, BandEnd::kLeast);
    EXPECT_LT(outside.worst_ratio, 1);
    EXPECT_NEAR(outside.energy, inside.energy, 2e-5 * inside.energy);
  }
}

TEST(SolveBand, SaysWhereNoCurveIsInside) {
  BandProblem band = on_knots({0, 4}, 3);
  for (int i = 0; i <= 8; ++i)
    band.samples.push_back(ball(i * 0.5, {i * 0.5, i % 2 == 0 ? 0.0 : 1.0, 0}, 0.3));
  const BandCurve found = solve_band(band, straight(band.basis));
  EXPECT_EQ(found.end, BandEnd::kOutside);
  EXPECT_GT(found.worst_ratio, 1);
}

TEST(SolveBand, ACylinderAllowsAsMuchAsABallAtLeast) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomBand balls(seed, 0.1);
    const RandomBand cylinders(seed, 0.1, BandShape::kCylinder);
    const BandCurve held = solve_band(balls.problem, balls.start);
    const BandCurve sliding = solve_band(cylinders.problem, cylinders.start);
    ASSERT_EQ(sliding.end, BandEnd::kLeast);
    EXPECT_LE(sliding.energy, held.energy * (1 + 2e-5));
  }
}

TEST(SolveBand, TurnsWithTheProblemIntoSpace) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomBand band(seed, 0.1, BandShape::kCylinder);
    const BandCurve found = solve_band(band.problem, band.start);
    std::mt19937 random(seed);
    const Motion motion = random_motion(random);
    for (BandSample& sample : band.problem.samples) {
      sample.foot = motion(sample.foot);
      sample.direction = motion.turn * sample.direction;
    }
    for (Point3& p : band.start) p = motion(p);
    const BandCurve turned = solve_band(band.problem, band.start);
    for (std::size_t i = 0; i < band.start.size(); ++i) {
      EXPECT_LE((turned.curve.control_points()[i] - motion(found.curve.control_points()[i])).norm(),
                1e-5);
    }
  }
}

TEST(SolveBand, NoiseInsideTheBandBecomesStraight) {
  BandProblem band = on_knots({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, 3);
  std::vector<Point3> start = straight(band.basis);
  for (std::size_t i = 0; i < start.size(); ++i) start[i].y() = i % 2 == 0 ? 0.05 : -0.05;
  for (double u = 0; u <= 10; u += 0.25) band.samples.push_back(along_x(u, {u, 0, 0}, 0.1));
  const BandCurve found = solve_band(band, start);
  EXPECT_EQ(found.end, BandEnd::kLeast);
  for (double u = 0; u <= 10; u += 0.1) EXPECT_LE(found.curve.curvature_at(u), 1e-9);
}

TEST(SolveBand, LongRunsTakeHardlyMoreSteps) {
  int few = 0;
  for (const int spans : {100, 3000}) {
    const RandomBand run(1, 0.05, BandShape::kCylinder, spans);
    const BandCurve found = solve_band(run.problem, run.start);
    EXPECT_EQ(found.end, BandEnd::kLeast);
    if (spans == 100) few = found.steps;
    EXPECT_LE(found.steps, 2 * few);
  }
}

TEST(SolveBand, RefusesWhatItCannotUnderstand) {
  const BandProblem band = on_knots({0, 1, 2}, 3);
  const std::vector<Point3> start = straight(band.basis);
  EXPECT_THROW((void)solve_band(band, std::vector<Point3>(3)), std::invalid_argument);
  const auto expect_refused = [&](const auto& change) {
    BandProblem other = band;
    change(other);
    EXPECT_THROW((void)solve_band(other, start), std::invalid_argument);
  };
  expect_refused([](BandProblem& b) { b.samples = {ball(1, Point3::Zero(), 0)}; });
  expect_refused([](BandProblem& b) { b.held = {HeldPoint::at(9, Point3::Zero())}; });
  expect_refused([](BandProblem& b) { b.energy = 1; });
}

}  // namespace
}  // namespace batten::geometry
