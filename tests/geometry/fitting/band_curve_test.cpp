#include "geometry/fitting/band_curve.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <random>
#include <stdexcept>
#include <vector>

#include "tests/support/corners.h"

namespace batten::geometry {
namespace {

// --- the linear system -------------------------------------------------------------------------

// B B^T + I / 10 of random blocks, B lower banded; and the same as a dense matrix.
struct BlockSystem {
  BlockBandedMatrix banded;
  Eigen::MatrixXd dense;
  std::vector<Point3> right;
  Eigen::VectorXd right_dense;

  explicit BlockSystem(int size, unsigned seed = 1) : banded(size) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(3 * size, 3 * size);
    for (int i = 0; i < 3 * size; ++i) {
      for (int j = 3 * std::max(0, i / 3 - 3); j < 3 * (i / 3 + 1); ++j) b(i, j) = uniform(random);
    }
    dense = b * b.transpose() + Eigen::MatrixXd::Identity(3 * size, 3 * size) / 10;
    right_dense = Eigen::VectorXd(3 * size);
    for (int i = 0; i < size; ++i) {
      for (int k = 0; k <= std::min(i, 3); ++k) {
        banded.at(i, k) = dense.block<3, 3>(3 * i, 3 * (i - k));
      }
      right.emplace_back(uniform(random), uniform(random), uniform(random));
      right_dense.segment<3>(3 * i) = right.back();
    }
  }
};

TEST(BlockBandedMatrix, SolvesAsADenseMatrixDoes) {
  for (const int size : {1, 2, 3, 4, 5, 9, 40}) {
    SCOPED_TRACE(testing::Message() << "size " << size);
    BlockSystem system(size);
    const Eigen::VectorXd expected = system.dense.llt().solve(system.right_dense);
    ASSERT_TRUE(system.banded.factor());
    system.banded.solve(system.right);
    for (int i = 0; i < size; ++i) {
      EXPECT_LE((system.right[i] - expected.segment<3>(3 * i)).norm(), 1e-9) << i;
    }
  }
}

TEST(BlockBandedMatrix, ARestrictedUnknownMovesOnlyWhereItMay) {
  BlockSystem system(9);
  const Vector3 line = Vector3(1, 2, -2) / 3;
  system.banded.restrict(4, line * line.transpose());
  system.right[4] = line * line.dot(system.right[4]);
  // Independently: unknown 4 is s * line, so its three columns are one.
  Eigen::MatrixXd columns = Eigen::MatrixXd::Identity(27, 25);
  columns.middleCols(12, 13).setZero();
  columns.block<3, 1>(12, 12) = line;
  columns.bottomRightCorner(12, 12).setIdentity();
  Eigen::VectorXd right = system.right_dense;
  right.segment<3>(12) = system.right[4];
  const Eigen::VectorXd expected =
      columns *
      (columns.transpose() * system.dense * columns).llt().solve(columns.transpose() * right);
  ASSERT_TRUE(system.banded.factor());
  system.banded.solve(system.right);
  for (int i = 0; i < 9; ++i) {
    EXPECT_LE((system.right[i] - expected.segment<3>(3 * i)).norm(), 1e-9) << i;
  }
}

TEST(BlockBandedMatrix, RefusesWhatIsNotPositiveDefinite) {
  BlockSystem system(5);
  system.banded.at(3, 0) -= 1000 * Eigen::Matrix3d::Identity();
  EXPECT_FALSE(system.banded.factor());
}

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
    const BandCurve found = solve_band(beam, straight(beam.basis), {});
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
  EXPECT_NEAR(solve_band(beam, straight(beam.basis), {}).energy, 3, 1e-3);
  // A stiff right half leaves the bending to the left.
  const auto bending = [](const BsplineCurve& curve, double u) {
    return curve.derivative_at(u, 2).squaredNorm();
  };
  beam.weight = [](double u) { return EnergyWeight{u < 1 ? 1.0 : 100.0, Vector3::Zero()}; };
  const BandCurve found = solve_band(beam, straight(beam.basis), {});
  EXPECT_LT(bending(found.curve, 1.5), 0.1 * bending(found.curve, 0.5));
}

// Run at uneven speed along x, a line has no energy across x.
TEST(SolveBand, EnergyAlongADirectionMayBeLeftOut) {
  BandProblem line = on_knots({0, 1, 2}, 2);
  std::vector<Point3> start = straight(line.basis);
  start[2].x() += 0.5;
  for (std::size_t i = 0; i < start.size(); ++i) line.held.push_back(HeldPoint::at(i, start[i]));
  const double all = solve_band(line, start, {}).energy;
  line.weight = [](double) { return EnergyWeight{1, Vector3::UnitX()}; };
  EXPECT_LT(solve_band(line, start, {}).energy, 0.01 * all);
  line.weight = [](double) { return EnergyWeight{1, Vector3::UnitY()}; };
  EXPECT_NEAR(solve_band(line, start, {}).energy, all, 1e-9 * all);
}

TEST(SolveBand, HeldPointsGoWhereTheyMayOnly) {
  BandProblem beam = on_knots({0, 1, 2}, 2);
  beam.samples = {ball(1, {1, 1, 1}, 0.25)};
  beam.held = {HeldPoint::at(0, {0, 0, 0}),
               HeldPoint::on_plane(2, {1, 0, 0.125}, Vector3::UnitZ())};
  const BandCurve found = solve_band(beam, straight(beam.basis), {});
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
  const BandCurve found = least_ratio_in_band(move, start, 3, {});
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

  explicit RandomBand(unsigned seed, double radius = 0.2, BandShape shape = BandShape::kBall)
      : problem{on_knots({0, 1}, 3)} {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-0.5, 0.5);
    constexpr int kSpans = 20;
    std::vector<double> breaks;
    double at = 0;
    for (int i = 0; i <= kSpans; ++i) breaks.push_back(at += 1 + noise(random));
    problem = on_knots(breaks, 2 + static_cast<int>(seed % 2));
    std::vector<Point3> points = straight(problem.basis);
    for (Point3& p : points) p += 0.3 * Vector3(noise(random), noise(random), noise(random));
    const BsplineCurve path(problem.basis, points);
    for (int i = 0; i < kSpans; ++i) {
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
    const BandCurve found = solve_band(band.problem, band.start, {});
    ASSERT_EQ(found.end, BandEnd::kLeast);
    EXPECT_LT(found.worst_ratio, 1);
    // The problem is convex: on the way to any other curve inside, the energy rises.
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 20; ++i) {
      BandProblem other = band.problem;
      std::vector<Point3> points = band.start;
      const double wild = normal(random);
      other.weight = [wild](double u) {
        return EnergyWeight{std::exp(wild * std::sin(3 * u)), Vector3::Zero()};
      };
      const BandCurve away = solve_band(other, points, {});
      ASSERT_LT(away.worst_ratio, 1);
      BandProblem plain = band.problem;
      plain.samples.clear();
      points = away.curve.control_points();
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
    const BandCurve inside = solve_band(band.problem, band.start, {});
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> off(-2, 2);
    for (Point3& p : band.start) p += Vector3(off(random), off(random), off(random));
    const BandCurve outside = solve_band(band.problem, band.start, {});
    ASSERT_EQ(outside.end, BandEnd::kLeast);
    EXPECT_LT(outside.worst_ratio, 1);
    EXPECT_NEAR(outside.energy, inside.energy, 2e-5 * inside.energy);
  }
}

TEST(SolveBand, SaysWhereNoCurveIsInside) {
  BandProblem band = on_knots({0, 4}, 3);
  for (int i = 0; i <= 8; ++i)
    band.samples.push_back(ball(i * 0.5, {i * 0.5, i % 2 == 0 ? 0.0 : 1.0, 0}, 0.3));
  const BandCurve found = solve_band(band, straight(band.basis), {});
  EXPECT_EQ(found.end, BandEnd::kOutside);
  EXPECT_GT(found.worst_ratio, 1);
}

TEST(SolveBand, ACylinderAllowsAsMuchAsABallAtLeast) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const RandomBand balls(seed, 0.1);
    const RandomBand cylinders(seed, 0.1, BandShape::kCylinder);
    const BandCurve held = solve_band(balls.problem, balls.start, {});
    const BandCurve sliding = solve_band(cylinders.problem, cylinders.start, {});
    ASSERT_EQ(sliding.end, BandEnd::kLeast);
    EXPECT_LE(sliding.energy, held.energy * (1 + 2e-5));
  }
}

TEST(SolveBand, TurnsWithTheProblemIntoSpace) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    RandomBand band(seed, 0.1, BandShape::kCylinder);
    const BandCurve found = solve_band(band.problem, band.start, {});
    std::mt19937 random(seed);
    const Motion motion = random_motion(random);
    for (BandSample& sample : band.problem.samples) {
      sample.foot = motion(sample.foot);
      sample.direction = motion.turn * sample.direction;
    }
    for (Point3& p : band.start) p = motion(p);
    const BandCurve turned = solve_band(band.problem, band.start, {});
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
  const BandCurve found = solve_band(band, start, {});
  EXPECT_EQ(found.end, BandEnd::kLeast);
  for (double u = 0; u <= 10; u += 0.1) EXPECT_LE(found.curve.curvature_at(u), 1e-9);
}

// A wavy run with noise, three samples per span, in a band of .05 mm.
BandProblem long_run(int spans, std::vector<Point3>& start) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-0.03, 0.03);
  std::vector<double> breaks;
  for (int i = 0; i <= spans; ++i) breaks.push_back(i);
  BandProblem run = on_knots(breaks, 3);
  start = straight(run.basis);
  for (Point3& p : start) p += Vector3(0, 3 * std::sin(p.x() / 6) + noise(random), noise(random));
  const BsplineCurve path(run.basis, start);
  for (int i = 0; i < 3 * spans; ++i) {
    const double u = (i + 0.5) / 3;
    BandSample sample = ball(u, path.point_at(u), 0.05);
    sample.shape = BandShape::kCylinder;
    sample.direction = path.direction_at(u);
    run.samples.push_back(sample);
  }
  return run;
}

TEST(SolveBand, LongRunsTakeHardlyMoreSteps) {
  int few = 0;
  for (const int spans : {100, 3000}) {
    std::vector<Point3> start;
    const BandProblem run = long_run(spans, start);
    const std::clock_t before = std::clock();
    const BandCurve found = solve_band(run, start, {});
    const double seconds = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
    std::printf("%d samples: %d steps, %.2f us per sample and step\n", 3 * spans, found.steps,
                1e6 * seconds / (3.0 * spans * found.steps));
    EXPECT_EQ(found.end, BandEnd::kLeast);
    if (spans == 100) few = found.steps;
    EXPECT_LE(found.steps, 2 * few);
  }
}

TEST(SolveBand, RefusesWhatItCannotUnderstand) {
  BandProblem band = on_knots({0, 1, 2}, 3);
  const std::vector<Point3> start = straight(band.basis);
  EXPECT_THROW((void)solve_band(band, std::vector<Point3>(3), {}), std::invalid_argument);
  band.samples = {ball(1, Point3::Zero(), 0)};
  EXPECT_THROW((void)solve_band(band, start, {}), std::invalid_argument);
  band.samples.clear();
  band.held = {HeldPoint::at(9, Point3::Zero())};
  EXPECT_THROW((void)solve_band(band, start, {}), std::invalid_argument);
  band.held.clear();
  band.energy = 1;
  EXPECT_THROW((void)solve_band(band, start, {}), std::invalid_argument);
}

}  // namespace
}  // namespace batten::geometry
